// SPDX-License-Identifier: Apache-2.0
#include "lab/report/curves.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <weft/core/statistics.hpp>

#include "lab/metrics/field.hpp"
#include "lab/statistics/bootstrap.hpp"

namespace weft::lab {
namespace {

constexpr std::size_t kMostPoints = 256;    ///< points of a plotted distribution
constexpr std::size_t kMostIntervals = 24;  ///< intervals of a band

std::vector<double> sorted_errors(const Results& results, const Combination& combination) {
  std::vector<double> errors;
  for (const std::size_t index : combination.cells) {
    for (const FrameError& error : results.record(results.plan.cells[index]).errors) {
      if (std::isfinite(error.mean_mm)) errors.push_back(error.mean_mm);
    }
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

using ErrorsByFrame = std::map<std::uint64_t, std::map<std::string, double>>;  ///< by sequence

/// [mm] at each frame with truth, of each sequence that was solved there the mean over its seeds.
ErrorsByFrame errors_by_frame(const Results& results, const Combination& combination) {
  std::map<std::uint64_t, std::map<std::string, std::vector<double>>> seeds;
  for (const std::size_t index : combination.cells) {
    const PlanCell& cell = results.plan.cells[index];
    for (const FrameError& error : results.record(cell).errors) {
      auto& sequences = seeds[error.frame];
      if (std::isfinite(error.mean_mm)) sequences[cell.sequence].push_back(error.mean_mm);
    }
  }
  ErrorsByFrame errors;
  for (const auto& [frame, sequences] : seeds) {
    auto& means = errors[frame];
    for (const auto& [name, values] : sequences) means[name] = mean(values);
  }
  return errors;
}

ErrorsByFrame differences(const ErrorsByFrame& errors, const ErrorsByFrame& others) {
  ErrorsByFrame result;
  for (const auto& [frame, sequences] : errors) {
    auto& own = result[frame];
    const auto other = others.find(frame);
    if (other == others.end()) continue;
    for (const auto& [name, value] : sequences) {
      const auto found = other->second.find(name);
      if (found != other->second.end()) own[name] = value - found->second;
    }
  }
  return result;
}

Curve curve_of(const ErrorsByFrame& errors, bool with_band) {
  const std::size_t step = (errors.size() + kMostIntervals - 1) / kMostIntervals;
  Curve curve;
  for (const auto& [frame, sequences] : errors) {
    std::vector<double> values;
    for (const auto& [name, value] : sequences) values.push_back(value);
    const bool has_interval =
        with_band && (curve.x.size() % step == 0 || curve.x.size() + 1 == errors.size());
    curve.x.push_back(static_cast<float>(frame));
    curve.y.push_back(static_cast<float>(mean(values)));
    if (has_interval) curve.band.add(static_cast<double>(frame), bootstrap_interval(values));
  }
  return curve;
}

std::vector<float> shares_of(const std::vector<std::int64_t>& counts) {
  const std::int64_t total = std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
  std::vector<float> shares;
  if (total == 0) return shares;
  for (const std::int64_t count : counts) {
    shares.push_back(
        static_cast<float>(kPercent * static_cast<double>(count) / static_cast<double>(total)));
  }
  return shares;
}

}  // namespace

void Band::add(double place, const Interval& interval) {
  if (std::isnan(interval.low)) return;
  x.push_back(static_cast<float>(place));
  low.push_back(static_cast<float>(interval.low));
  high.push_back(static_cast<float>(interval.high));
}

Curve distribution_of(const Results& results, const Combination& combination) {
  const std::vector<double> errors = sorted_errors(results, combination);
  Curve curve;
  if (errors.empty()) return curve;
  const std::size_t points = std::min(errors.size(), kMostPoints);
  for (std::size_t i = 0; i < points; ++i) {
    const std::size_t rank = (i + 1) * errors.size() / points;
    curve.x.push_back(static_cast<float>(errors[rank - 1]));
    curve.y.push_back(static_cast<float>(100.0 * static_cast<double>(rank) /
                                         static_cast<double>(combination.truth_frames)));
  }
  return curve;
}

std::vector<FrameCurve> errors_over_frames(const Results& results, const ReportTables& tables,
                                           std::size_t reference,
                                           const std::vector<std::size_t>& banded) {
  std::vector<FrameCurve> curves(tables.combinations.size());
  if (reference >= curves.size()) return curves;
  const ErrorsByFrame others = errors_by_frame(results, tables.combinations[reference]);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    if (!tables.combinations[i].selectable) continue;
    const ErrorsByFrame errors = errors_by_frame(results, tables.combinations[i]);
    const bool with_band = std::count(banded.begin(), banded.end(), i) > 0;
    curves[i] = {curve_of(errors, with_band), curve_of(differences(errors, others), with_band)};
  }
  return curves;
}

ScoreShares scores_of(const FilterRates& rates) {
  return {shares_of(rates.scores_of_mismatches), shares_of(rates.scores_of_correct)};
}

}  // namespace weft::lab
