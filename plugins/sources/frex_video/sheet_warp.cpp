// SPDX-License-Identifier: Apache-2.0
#include "sheet_warp.hpp"

#include <string>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

namespace weft::frex_video {

Result<SheetWarp> fit_warp(const MarkerSheet& sheet, std::vector<SeenMarker> markers,
                           std::size_t least, double max_distance_px) {
  constexpr double kLambda = 1e-6;
  const std::size_t found = markers.size();
  for (;;) {
    if (markers.size() < least) {
      return no_result("of " + std::to_string(sheet.markers.size()) + " markers " +
                       std::to_string(found) + " are found and " + std::to_string(markers.size()) +
                       " agree, but " + std::to_string(least) + " are needed");
    }
    const auto count = static_cast<Eigen::Index>(markers.size());
    Points2 sites_mm(count, 2), images_px(count, 2);
    for (Eigen::Index i = 0; i < count; ++i) {
      const SeenMarker& seen = markers[to_index(i)];
      sites_mm.row(i) = sheet.markers[seen.marker].centre_mm().transpose();
      images_px.row(i) = seen.centre_px.transpose();
    }
    auto fitted =
        fit_thin_plate(sites_mm, images_px, Eigen::VectorXd::Constant(count, kLambda), true);
    if (!fitted) return fitted.error();
    const Eigen::VectorXd distances_px = fitted->left_out.rowwise().norm();
    Eigen::Index worst = 0;
    if (distances_px.maxCoeff(&worst) <= max_distance_px) {
      const double median_px = median({distances_px.data(), to_index(count)});
      return SheetWarp{std::move(fitted->spline), std::move(markers), median_px};
    }
    markers.erase(markers.begin() + worst);
  }
}

}  // namespace weft::frex_video
