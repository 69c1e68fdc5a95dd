// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/shapes/nearest.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace weft::lab {

namespace {

namespace index = boost::geometry::index;

using TreePoint = boost::geometry::model::point<double, 3, boost::geometry::cs::cartesian>;
using TreeBox = boost::geometry::model::box<TreePoint>;
using TreeEntry = std::pair<TreeBox, std::size_t>;

TreePoint tree_point(const Eigen::Vector3d& point) { return {point.x(), point.y(), point.z()}; }

TreeBox tree_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return {tree_point(low), tree_point(high)};
}

}  // namespace

/// Ericson, Real-Time Collision Detection, 2005, 5.1.5: by the region of the plane in which the
/// point lies.
double distance_to(const Corners& corners, const Eigen::Vector3d& point) {
  const auto& [a, b, c] = corners;
  const Eigen::Vector3d ab = b - a, ac = c - a;
  const auto to_segment = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& way) {
    const double length2 = way.squaredNorm();
    const double at = length2 > 0.0 ? std::clamp((point - from).dot(way) / length2, 0.0, 1.0) : 0.0;
    return (from + at * way - point).norm();
  };
  const Eigen::Vector3d normal = ab.cross(ac);
  const double area2 = normal.squaredNorm();
  if (area2 > 0.0) {
    const Eigen::Vector3d ap = point - a;
    const double v = ap.cross(ac).dot(normal) / area2, w = ab.cross(ap).dot(normal) / area2;
    if (v >= 0.0 && w >= 0.0 && v + w <= 1.0) return std::abs(ap.dot(normal)) / std::sqrt(area2);
  }
  return std::min({to_segment(a, ab), to_segment(a, ac), to_segment(b, c - b)});
}

struct NearestPlace::Index {
  std::vector<Corners> triangles;
  index::rtree<TreeEntry, index::quadratic<16>> tree;
  std::vector<TreeEntry> found;

  double least_of_found(const Eigen::Vector3d& point) const {
    double least = std::numeric_limits<double>::infinity();
    for (const TreeEntry& entry : found) {
      least = std::min(least, distance_to(triangles[entry.second], point));
    }
    return least;
  }
};

NearestPlace::NearestPlace(std::vector<Corners> triangles) {
  std::vector<TreeEntry> entries;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& [a, b, c] = triangles[i];
    entries.emplace_back(tree_box(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)), i);
  }
  index_.reset(new Index{std::move(triangles), decltype(Index::tree)(entries), {}});
}

NearestPlace::~NearestPlace() = default;

double NearestPlace::distance(const Eigen::Vector3d& point) const {
  std::vector<TreeEntry>& found = index_->found;
  found.clear();
  index_->tree.query(index::nearest(tree_point(point), 4), std::back_inserter(found));
  const double least = index_->least_of_found(point);
  if (found.empty()) return least;
  // Another may be nearer although its box is farther off than theirs.
  found.clear();
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(least);
  index_->tree.query(index::intersects(tree_box(point - reach, point + reach)),
                     std::back_inserter(found));
  return std::min(least, index_->least_of_found(point));
}

struct NearestPoint::Index {
  index::rtree<TreePoint, index::quadratic<16>> tree;
};

NearestPoint::NearestPoint(const std::vector<Eigen::Vector3d>& points) {
  std::vector<TreePoint> places;
  places.reserve(points.size());
  for (const Eigen::Vector3d& point : points) places.push_back(tree_point(point));
  index_.reset(new Index{decltype(Index::tree)(places)});
}

NearestPoint::~NearestPoint() = default;

double NearestPoint::distance(const Eigen::Vector3d& point) const {
  const TreePoint place = tree_point(point);
  double least = std::numeric_limits<double>::infinity();
  for (auto found = index_->tree.qbegin(index::nearest(place, 1)); found != index_->tree.qend();
       ++found) {
    least = boost::geometry::distance(*found, place);
  }
  return least;
}

}  // namespace weft::lab
