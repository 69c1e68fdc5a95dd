// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lab/statistics/unknown.hpp"

/// ROC curves of filters; positive is a mismatch (Shetab-Bushehri et al. 2023, Section V).
namespace weft::lab {

/// A threshold and the rates that it gives: of one frame or trial, or means over many.
struct RocPoint {
  double threshold = 0.0;         ///< in the filter's unit
  double fpr_percent = kUnknown;  ///< [] share of the inliers that were rejected; NaN without an
                                  ///< inlier
  double tpr_percent = kUnknown;  ///< [] mismatches rejected; NaN without a mismatch
};

struct RocCurve {
  std::vector<RocPoint> points;  ///< in ascending FPR, then TPR
  std::int64_t undefined = 0;    ///< [] thresholds without an FPR or a TPR: no points of the curve
  double auc_percent = kUnknown;
  double partial_auc_percent = kUnknown;  ///< [] FPR <= 10 %, of the largest possible
};

/// Sorts points and computes the area under them by the trapezoid rule, with (0, 0) and (100, 100)
/// added; no envelope. The area is 100 % for a perfect filter and 50 % for chance (5 % for the
/// partial area). Without points the areas are unknown.
RocCurve roc_curve(std::vector<RocPoint> points);

/// Averages rates at each threshold first, FPR and TPR each over the frames that have them: the
/// paper's "average over 60 images using a specific value".
RocCurve average_roc_curve(const std::vector<RocPoint>& frames);

}  // namespace weft::lab
