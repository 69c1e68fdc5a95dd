// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <numeric>
#include <vector>
#include <weft/core/index.hpp>

namespace weft::matchers {

/// Finite points of the plane sorted by y, to find those near a place.
class PointIndex {
 public:
  /// `at(i)` is point i as an Eigen::Vector2d.
  template <class At>
  void load(int count, At&& at) {
    points_.resize(to_index(count));
    for (int i = 0; i < count; ++i) points_[to_index(i)] = {at(i), i};
    std::sort(points_.begin(), points_.end(), [](const Point& a, const Point& b) {
      return a.xy.y() < b.xy.y() || (a.xy.y() == b.xy.y() && a.index < b.index);
    });
  }

  /// Calls visit(i) for each point within `radius` of `place`, the circle included.
  template <class Visit>
  void for_each_within(const Eigen::Vector2d& place, double radius, Visit&& visit) const {
    const auto first =
        std::lower_bound(points_.begin(), points_.end(), place.y() - radius,
                         [](const Point& point, double y) { return point.xy.y() < y; });
    for (auto it = first; it != points_.end() && it->xy.y() <= place.y() + radius; ++it) {
      if ((it->xy - place).squaredNorm() <= radius * radius) visit(it->index);
    }
  }

 private:
  struct Point {
    Eigen::Vector2d xy;
    int index;
  };
  std::vector<Point> points_;
};

}  // namespace weft::matchers
