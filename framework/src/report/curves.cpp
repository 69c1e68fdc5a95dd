// SPDX-License-Identifier: Apache-2.0
#include "report/curves.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <weft/core/statistics.hpp>

#include "metrics/field.hpp"

namespace weft::evaluation {
namespace {

constexpr std::size_t kMostPoints = 256;  ///< of a drawn distribution

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

Curve error_over_frames(const Results& results, const Combination& combination) {
  std::map<std::uint64_t, std::map<std::string, std::vector<double>>> by_frame;
  for (const std::size_t index : combination.cells) {
    const PlanCell& cell = results.plan.cells[index];
    for (const FrameError& error : results.record(cell).errors) {
      auto& values = by_frame[error.frame];
      if (std::isfinite(error.mean_mm)) values[cell.sequence].push_back(error.mean_mm);
    }
  }
  Curve curve;
  for (const auto& [frame, sequences] : by_frame) {
    std::vector<double> means;
    for (const auto& [name, values] : sequences) means.push_back(mean(values));
    curve.x.push_back(static_cast<float>(frame));
    curve.y.push_back(static_cast<float>(mean(means)));
  }
  return curve;
}

ScoreShares scores_of(const FilterRates& rates) {
  return {shares_of(rates.scores_of_mismatches), shares_of(rates.scores_of_correct)};
}

}  // namespace weft::evaluation
