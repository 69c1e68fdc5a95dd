// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "report/tables.hpp"

/// The curves that the figures of a report draw.
namespace weft::evaluation {

struct Curve {
  std::vector<float> x, y;
};

/// Share y [%] of all frames with truth whose error is at most x [mm], ascending. A frame without
/// an error stays above every x, so that failures keep the curve below 100 %. Runs of many frames
/// are drawn at evenly spaced ranks.
Curve distribution_of(const Results& results, const Combination& combination);

/// Mean error y [mm] at frame x over sequences, each the mean over its seeds.
Curve error_over_frames(const Results& results, const Combination& combination);

/// Shares [%] of the mismatches, and of the correct matches, with a score in equal parts of [0, 1].
/// Empty where there is none of them.
struct ScoreShares {
  std::vector<float> mismatches, correct;
};

ScoreShares scores_of(const FilterRates& rates);

/// Along the number that an axis sweeps, all other values fixed.
struct SweepCurve {
  std::vector<std::string> others;  ///< values of the other axes; of this one the family, if any
  std::vector<float> values;        ///< of the number
  std::vector<std::vector<float>> figures;                        ///< for each measure one a value
  double auc_percent = kUnknown, partial_auc_percent = kUnknown;  ///< [] of a ROC curve
};

/// What the number that an axis sweeps does. A ROC curve has the measures FPR and TPR, in this
/// order, and its points in ascending FPR.
struct Sweep {
  std::size_t axis = 0;
  std::string stage;  ///< the filter of a ROC curve, else empty
  std::vector<std::string> measures;
  std::vector<SweepCurve> curves;
};

/// What tells the curves of a sweep apart, as axes: the other axes, and the families of this one.
std::vector<PlanAxis> other_axes(const Results& results, const Sweep& sweep);

/// A sweep of every axis that sweeps a number, and a ROC curve where it is the threshold of a
/// filter: where it changes what a stage rejects, but not what the stage is given.
std::vector<Sweep> sweeps_of(const Results& results, const ReportTables& tables);

}  // namespace weft::evaluation
