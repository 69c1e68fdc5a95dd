// SPDX-License-Identifier: Apache-2.0
#include "common/convex/weighed_matches.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <weft/core/statistics.hpp>

namespace weft::solvers {

Result<void> WeighedMatches::read(const Correspondences& matches, const Template& templ) {
  auto points = seen_points(matches, templ, kFewest);
  if (!points) return points.error();
  points_ = *std::move(points);
  weights_.assign(points_.size(), 1.0);
  return {};
}

bool WeighedMatches::weigh_again(const Points3View& vertices_m, const Camera& camera,
                                 double radius_px) {
  const std::vector<double> errors_px = reprojection_errors_px(points_, camera, vertices_m);
  std::vector<SeenPoint> near;
  std::vector<double> near_px;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!(errors_px[i] <= radius_px)) continue;
    near.push_back(points_[i]);
    near_px.push_back(errors_px[i]);
  }
  if (near.size() == points_.size() || near.size() < kFewest) return false;
  const double usual_px = median(near_px) + 1e-9;
  points_ = std::move(near);
  weights_.clear();
  // Below exp(-20) a match is as good as none, and the program is badly scaled.
  for (const double r : near_px) weights_.push_back(std::exp(-std::min(r / usual_px, 20.0)));
  return true;
}

}  // namespace weft::solvers
