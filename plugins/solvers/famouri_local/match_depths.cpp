// SPDX-License-Identifier: Apache-2.0
#include "match_depths.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/statistics.hpp>

namespace weft::famouri_local {
namespace {

constexpr double kFirstNoisePx = 1.0;     // before the noise is estimated from the matches
constexpr double kLeastNoisePx = 0.02;    // noise of exact matches: their maps are no quadrics
constexpr double kContradictsStds = 5.0;  // standard deviations of noise, from its map
constexpr double kContradictsLeastPx = 2.0;
constexpr double kThinnest = 0.02;                 // share of the usual area of a map
constexpr double kClosest = 0.2, kFurthest = 5.0;  // ratios to the usual distance

}  // namespace

const MatchDepths& DepthFinder::find(const std::vector<solvers::SeenPoint>& points,
                                     const Camera& camera, const Points3View& rest_m,
                                     double frontal_m, const DepthOptions& options) {
  const double diagonal_m = (rest_m.colwise().maxCoeff() - rest_m.colwise().minCoeff()).norm();
  const double reach_m = options.reach * diagonal_m;
  const double focal_px = 0.5 * (camera.fx + camera.fy);
  found_ = {};
  // A second derivative of eta is about a curvature of the surface over its distance.
  MapExpectation expected{kFirstNoisePx / focal_px, options.bend_rad / diagonal_m / frontal_m,
                          false};
  maps_.gather(points, camera, rest_m, options.neighbours, reach_m);
  maps_.fit(expected);
  if (!(maps_.noise() >= 0.0)) {
    found_.undetermined = static_cast<int>(points.size());
    return found_;
  }
  expected.noise = std::max(maps_.noise(), kLeastNoisePx / focal_px);
  leave_out_contradicting(points, expected.noise, focal_px);
  expected.is_noise_known = true;
  if (found_.contradicting > 0) {
    maps_.gather(agreeing_, camera, rest_m, options.neighbours, reach_m);
  }
  maps_.fit(expected);
  found_.noise_px = expected.noise * focal_px;
  found_.mean_count = maps_.mean_count();
  read_depths();
  leave_out_odd();
  return found_;
}

void DepthFinder::leave_out_contradicting(const std::vector<solvers::SeenPoint>& points,
                                          double noise, double focal_px) {
  const double most = std::max(kContradictsStds * noise, kContradictsLeastPx / focal_px);
  agreeing_.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& map = maps_.maps()[i];
    if (map && map->own_off > most) {
      ++found_.contradicting;
    } else {
      agreeing_.push_back(points[i]);
    }
  }
}

void DepthFinder::read_depths() {
  std::vector<double> areas;
  for (const auto& map : maps_.maps()) {
    if (map) areas.push_back(map->jacobian_per_m.determinant());
  }
  const double least_area = kThinnest * median_in_place(areas);
  for (std::size_t i = 0; i < agreeing_.size(); ++i) {
    const auto& map = maps_.maps()[i];
    found_.undetermined += map ? 0 : 1;
    if (!map) continue;
    const bool is_open = map->jacobian_per_m.determinant() > std::max(least_area, 0.0);
    const auto depth = is_open ? local_depth(*map) : std::nullopt;
    found_.folded += depth ? 0 : 1;
    if (!depth) continue;
    found_.points.push_back(agreeing_[i]);
    found_.depths.push_back(*depth);
  }
}

/// Excludes distances that cannot belong to the same object.
void DepthFinder::leave_out_odd() {
  std::vector<double> distances_m;
  for (const LocalDepth& depth : found_.depths) distances_m.push_back(depth.distance_m);
  const double usual_m = median_in_place(distances_m);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < found_.depths.size(); ++i) {
    const double distance_m = found_.depths[i].distance_m;
    const bool is_odd = distance_m < kClosest * usual_m || distance_m > kFurthest * usual_m;
    found_.odd += is_odd ? 1 : 0;
    if (is_odd) continue;
    found_.points[kept] = found_.points[i];
    found_.depths[kept++] = found_.depths[i];
  }
  found_.points.resize(kept);
  found_.depths.resize(kept);
}

}  // namespace weft::famouri_local
