// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>
#include <weft/core/index.hpp>

namespace weft::matchers {

/// Finite points of the plane in square cells, to find those near a place.
class PointGrid {
 public:
  /// `at(i)` is point i as an Eigen::Vector2d; the cells suit searches of about `radius`.
  template <class At>
  void load(int count, double radius, At&& at) {
    given_.clear();
    for (int i = 0; i < count; ++i) given_.push_back(at(i));
    lay_out(radius);
    first_.assign(to_index(columns_ * rows_) + 1, 0);
    for (const Eigen::Vector2d& xy : given_) ++first_[cell_of(xy) + 1];
    for (std::size_t cell = 1; cell < first_.size(); ++cell) first_[cell] += first_[cell - 1];
    points_.resize(given_.size());
    filled_.assign(first_.begin(), first_.end());
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector2d& xy = given_[to_index(i)];
      points_[filled_[cell_of(xy)]++] = {xy.x(), xy.y(), i};
    }
  }

  /// The points within `radius` of `place`, the circle included.
  void find_within(const Eigen::Vector2d& place, double radius, std::vector<int>& found) const {
    std::size_t count = 0;
    const int last = row(place.y() + radius);
    for (int y = row(place.y() - radius); y <= last; ++y) {
      // Points of this row of cells that the circle reaches; the outer rows hold all beyond them.
      const double low = low_.y() + y * cell_, high = low + cell_;
      const bool is_outer = y == 0 || y == rows_ - 1;
      const double off = is_outer ? 0.0 : std::max({low - place.y(), place.y() - high, 0.0});
      const double half = std::sqrt(std::max(radius * radius - off * off, 0.0)) + 1e-9 * radius;
      const int right = column(place.x() + half);
      const std::size_t end = first_[to_index(y * columns_ + right) + 1];
      const std::size_t begin = first_[to_index(y * columns_ + column(place.x() - half))];
      found.resize(count + (end - begin));
      for (std::size_t k = begin; k < end; ++k) {
        // Without a branch, which would be guessed wrong for many.
        const double dx = points_[k].x - place.x(), dy = points_[k].y - place.y();
        found[count] = points_[k].index;
        count += dx * dx + dy * dy <= radius * radius ? 1 : 0;
      }
    }
    found.resize(count);
  }

  /// Calls visit(i) for each of them.
  template <class Visit>
  void for_each_within(const Eigen::Vector2d& place, double radius, Visit&& visit) const {
    const int last = row(place.y() + radius);
    const int left = column(place.x() - radius), right = column(place.x() + radius);
    for (int y = row(place.y() - radius); y <= last; ++y) {
      const std::size_t end = first_[to_index(y * columns_ + right) + 1];
      for (std::size_t k = first_[to_index(y * columns_ + left)]; k < end; ++k) {
        const double dx = points_[k].x - place.x(), dy = points_[k].y - place.y();
        if (dx * dx + dy * dy <= radius * radius) visit(points_[k].index);
      }
    }
  }

 private:
  struct Point {
    double x, y;
    int index;
  };

  /// About as many cells as points, at most kMostAlong along each side.
  void lay_out(double radius) {
    constexpr double kMostAlong = 1024.0;
    Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = low;
    if (!given_.empty()) low = high = given_.front();
    for (const Eigen::Vector2d& xy : given_) {
      low = low.cwiseMin(xy);
      high = high.cwiseMax(xy);
    }
    const Eigen::Vector2d size = high - low;
    const double fair = std::sqrt(size.prod() / static_cast<double>(given_.size() + 1));
    cell_ = std::max({0.5 * radius, fair, size.maxCoeff() / kMostAlong, 1e-6});
    low_ = low;
    per_cell_ = 1.0 / cell_;
    columns_ = rows_ = static_cast<int>(kMostAlong);
    columns_ = column(high.x()) + 1;
    rows_ = row(high.y()) + 1;
  }

  /// Also of numbers that are not finite.
  static int within(double cells, int count) {
    return cells > 0.0 ? static_cast<int>(std::min(cells, count - 1.0)) : 0;
  }
  int column(double x) const { return within((x - low_.x()) * per_cell_, columns_); }
  int row(double y) const { return within((y - low_.y()) * per_cell_, rows_); }
  std::size_t cell_of(const Eigen::Vector2d& xy) const {
    return to_index(row(xy.y()) * columns_ + column(xy.x()));
  }

  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  double cell_ = 1.0, per_cell_ = 1.0;
  int columns_ = 1, rows_ = 1;
  std::vector<Eigen::Vector2d> given_;
  std::vector<std::size_t> first_, filled_;
  std::vector<Point> points_;
};

}  // namespace weft::matchers
