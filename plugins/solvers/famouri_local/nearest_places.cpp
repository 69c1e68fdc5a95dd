// SPDX-License-Identifier: Apache-2.0
#include "nearest_places.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::famouri_local {
namespace {

constexpr std::size_t kLeafSize = 8;
constexpr double kLeastCosine = 0.5;  // cosine of the angle between the normals of neighbours

}  // namespace

Eigen::Matrix<double, 3, 2> RestPlace::axes() const {
  // From the coordinate axis that is nearest to the plane, so that it does not depend on the face's
  // corners. The camera looks along -normal, so x, y and -normal are right-handed.
  Eigen::Index across = 0;
  normal.cwiseAbs().minCoeff(&across);
  const Eigen::Vector3d straight = Eigen::Vector3d::Unit(across);
  Eigen::Matrix<double, 3, 2> axes;
  axes.col(0) = (straight - straight.dot(normal) * normal).normalized();
  axes.col(1) = axes.col(0).cross(normal);
  return axes;
}

Eigen::Vector2d RestPlace::laid_out(const Eigen::Vector3d& other_m,
                                    const Eigen::Matrix<double, 3, 2>& axes) const {
  const Eigen::Vector3d offset_m = other_m - at_m;
  const Eigen::Vector2d flat_m = axes.transpose() * offset_m;
  const double length_m = flat_m.norm();
  return length_m > 0.0 ? Eigen::Vector2d(offset_m.norm() / length_m * flat_m) : flat_m;
}

std::vector<RestPlace> rest_places(std::span<const solvers::SeenPoint> points,
                                   const Points3View& rest_m) {
  std::vector<RestPlace> places;
  places.reserve(points.size());
  for (const solvers::SeenPoint& point : points) {
    const Eigen::Vector3d corner_m = rest_m.row(point.corners[0]);
    const Eigen::Vector3d one_m = rest_m.row(point.corners[1]).transpose() - corner_m;
    const Eigen::Vector3d other_m = rest_m.row(point.corners[2]).transpose() - corner_m;
    places.push_back({point.on(rest_m), one_m.cross(other_m).normalized()});
  }
  return places;
}

void NearestPlaces::build(std::vector<RestPlace> places) {
  places_ = std::move(places);
  order_.resize(places_.size());
  std::iota(order_.begin(), order_.end(), 0);
  axis_.assign(places_.size(), 0);
  split(0, order_.size());
}

/// Orders a range so that its middle place parts it along its longest side.
void NearestPlaces::split(std::size_t first, std::size_t end) {
  if (end - first <= kLeafSize) return;
  worked(static_cast<std::int64_t>(end - first));
  Eigen::Vector3d low_m = places_[to_index(order_[first])].at_m, high_m = low_m;
  for (std::size_t k = first; k < end; ++k) {
    const Eigen::Vector3d& at_m = places_[to_index(order_[k])].at_m;
    low_m = low_m.cwiseMin(at_m), high_m = high_m.cwiseMax(at_m);
  }
  Eigen::Index axis = 0;
  (high_m - low_m).maxCoeff(&axis);
  const std::size_t middle = first + (end - first) / 2;
  const auto at = [&](std::size_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
  std::nth_element(at(first), at(middle), at(end), [&](std::int32_t a, std::int32_t b) {
    return std::make_pair(places_[to_index(a)].at_m[axis], a) <
           std::make_pair(places_[to_index(b)].at_m[axis], b);
  });
  axis_[middle] = static_cast<std::uint8_t>(axis);
  split(first, middle);
  split(middle + 1, end);
}

void NearestPlaces::find(std::int32_t of, std::size_t count, double reach_m,
                         std::vector<NearPlace>& near) const {
  near.clear();
  search(0, order_.size(), {of, count, reach_m * reach_m, near});
}

void NearestPlaces::search(std::size_t first, std::size_t end, const Query& query) const {
  if (end - first <= kLeafSize) {
    for (std::size_t k = first; k < end; ++k) consider(order_[k], query);
    return;
  }
  const std::size_t middle = first + (end - first) / 2;
  const Eigen::Index axis = axis_[middle];
  const double beyond_m =
      places_[to_index(query.of)].at_m[axis] - places_[to_index(order_[middle])].at_m[axis];
  consider(order_[middle], query);
  const bool low_first = beyond_m < 0.0;
  low_first ? search(first, middle, query) : search(middle + 1, end, query);
  const bool is_full = query.near.size() == query.count;
  const double furthest_m2 = is_full ? query.near.back().distance2_m2 : query.reach2_m2;
  if (beyond_m * beyond_m > furthest_m2) return;
  low_first ? search(middle + 1, end, query) : search(first, middle, query);
}

void NearestPlaces::consider(std::int32_t index, const Query& query) const {
  const RestPlace& asks = places_[to_index(query.of)];
  const RestPlace& other = places_[to_index(index)];
  const NearPlace found{(other.at_m - asks.at_m).squaredNorm(), index};
  if (!(found.distance2_m2 <= query.reach2_m2)) return;
  if (index != query.of && !(other.normal.dot(asks.normal) > kLeastCosine)) return;
  const auto is_nearer = [](const NearPlace& a, const NearPlace& b) {
    return std::tie(a.distance2_m2, a.index) < std::tie(b.distance2_m2, b.index);
  };
  std::vector<NearPlace>& near = query.near;
  if (near.size() == query.count && !is_nearer(found, near.back())) return;
  if (near.size() == query.count) near.pop_back();
  near.insert(std::upper_bound(near.begin(), near.end(), found, is_nearer), found);
}

}  // namespace weft::famouri_local
