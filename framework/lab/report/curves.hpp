// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lab/report/tables/tables.hpp"

/// The curves that the figures of a report draw.
namespace weft::lab {

/// 95 % intervals by sequence, at some of the places of a curve.
struct Band {
  std::vector<float> x, low, high;  ///< [n] place; [n] bounds of the interval

  /// Leaves an unknown interval out: there are too few sequences.
  void add(double place, const Interval& interval);
};

struct Curve {
  std::vector<float> x, y;  ///< [n] place; [n] value
  Band band;
};

/// Share y [%] of all frames with truth whose error is at most x [mm], ascending. A frame without
/// an error stays above every x, so that failures keep the curve below 100 %. Runs of many frames
/// are plotted at evenly spaced ranks.
Curve distribution_of(const Results& results, const Combination& combination);

/// Means at frame x over sequences, each the mean over its seeds.
struct FrameCurve {
  Curve error;       ///< [mm]
  Curve difference;  ///< [mm] from that of the reference, over the sequences that have both
};

/// One for each combination, empty unless it is selectable; the reference is an index, bands are
/// for those that `banded` names.
std::vector<FrameCurve> errors_over_frames(const Results& results, const ReportTables& tables,
                                           std::size_t reference,
                                           const std::vector<std::size_t>& banded);

/// Shares [%] of the mismatches, and of the inliers, with a score in equal parts of [0, 1]. Each
/// list is empty if there are no such matches.
struct ScoreShares {
  std::vector<float> mismatches, correct;  ///< [parts] percent
};

ScoreShares scores_of(const FilterRates& rates);

/// The measure of a sweep that has bands.
inline constexpr const char* kErrorMeasure = "mean 3D error, mm";

/// Along the number that an axis sweeps, all other values fixed.
struct SweepCurve {
  std::vector<std::string> others;  ///< values of the other axes; of this one the family, if any
  std::vector<float> values;        ///< values of the number
  std::vector<std::vector<float>> figures;                        ///< for each measure one a value
  Band error_band;                                                ///< band of the mean 3D error
  double auc_percent = kUnknown, partial_auc_percent = kUnknown;  ///< [] of a ROC curve
};

/// The effect of the number that an axis sweeps. A ROC curve has the measures FPR and TPR, in this
/// order, and its points in ascending FPR.
struct Sweep {
  std::size_t axis = 0;               ///< [] index of the axis
  std::string stage;                  ///< the filter of a ROC curve, else empty
  std::vector<std::string> measures;  ///< [.] names
  std::vector<SweepCurve> curves;     ///< [.] one per setting of the other axes
};

/// The axes that distinguish the curves of a sweep: the other axes, and the families of this one.
std::vector<PlanAxis> other_axes(const Results& results, const Sweep& sweep);

/// A sweep of every axis that sweeps a number, with the measures that change along it. A threshold
/// of a filter also has a ROC curve: it changes the matches that the stage rejects, but not its
/// inputs.
std::vector<Sweep> sweeps_of(const Results& results, const ReportTables& tables);

}  // namespace weft::lab
