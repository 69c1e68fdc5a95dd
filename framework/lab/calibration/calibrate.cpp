// SPDX-License-Identifier: Apache-2.0
#include "lab/calibration/calibrate.hpp"

#include <algorithm>
#include <weft/core/statistics.hpp>

#include "lab/calibration/refusal.hpp"

namespace weft::calibration {
namespace {

/// A view is an outlier if its error exceeds the usual one by this factor, and a visible size in
/// px.
constexpr double kOdd = 3.0, kOdd_px = 0.3;

/// Moves the names of views that fit much worse than the others from `views` to `odd`.
bool exclude_odd_views(const Solution& solution, std::vector<View>& views,
                       std::vector<std::string>& odd) {
  std::vector<double> errors_px;
  for (const ViewError& error : solution.errors) errors_px.push_back(error.rms_px);
  const double most_px = std::max(kOdd_px, kOdd * median(errors_px));
  std::vector<View> kept;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (solution.errors[i].rms_px > most_px) {
      odd.push_back(views[i].name);
    } else {
      kept.push_back(std::move(views[i]));
    }
  }
  views = std::move(kept);
  return !odd.empty();
}

}  // namespace

Result<Calibration> calibrate(const std::vector<View>& views, const ImageSize& size,
                              int coefficients) {
  Calibration calibration;
  calibration.size = size;
  calibration.found = views.size();
  for (const std::size_t i : choose_views(views, size, kMostViews)) {
    calibration.views.push_back(views[i]);
  }
  for (int round = 0; round < 2; ++round) {
    if (const auto refused = refusal_of(calibration.views, size)) return no_result(*refused);
    auto solution = solve(calibration.views, size, coefficients);
    if (!solution) return solution.error();
    calibration.solution = *std::move(solution);
    if (round > 0 || !exclude_odd_views(calibration.solution, calibration.views, calibration.odd)) {
      break;
    }
  }
  if (const auto refused = refusal_of(calibration.solution, size)) return no_result(*refused);
  calibration.coverage = coverage_of(calibration.views, size);
  return calibration;
}

}  // namespace weft::calibration
