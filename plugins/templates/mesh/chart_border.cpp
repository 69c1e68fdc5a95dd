// SPDX-License-Identifier: Apache-2.0
#include "chart_border.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <weft/geometry/barycentric.hpp>

namespace weft::mesh {
namespace {

using outline::Polygon;

std::size_t furthest_from(const Polygon& border, const Eigen::Vector2d& point) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < border.size(); ++i) {
    if ((border[i] - point).squaredNorm() > (border[best] - point).squaredNorm()) best = i;
  }
  return best;
}

/// Corners that approximate the outline, in their order, beginning with distant corners.
std::vector<std::size_t> outline_corners(const Polygon& border, double tolerance) {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : border) centre += point / static_cast<double>(border.size());
  const std::size_t first = furthest_from(border, centre);
  const std::size_t second = furthest_from(border, border[first]);
  std::vector<std::size_t> corners{first, second};
  std::vector<std::pair<std::size_t, std::size_t>> open{{first, second}, {second, first}};
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    double most = tolerance * tolerance;
    std::size_t at = to;
    for (std::size_t i = (from + 1) % border.size(); i != to && i != from;
         i = (i + 1) % border.size()) {
      const double distance2 = segment_distance2(border[i], border[from], border[to]);
      if (distance2 > most) most = distance2, at = i;
    }
    if (at == to) continue;
    corners.push_back(at);
    open.emplace_back(from, at);
    open.emplace_back(at, to);
  }
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// A piece of a border by its arc.
class Arc {
 public:
  explicit Arc(Polygon points) : points_(std::move(points)) {
    for (std::size_t k = 1; k < points_.size(); ++k) {
      const double side = (points_[k] - points_[k - 1]).norm();
      sums_.push_back(sums_.back() + 0.5 * side * (points_[k] + points_[k - 1]));
      lengths_.push_back(lengths_.back() + side);
    }
  }
  double length() const { return lengths_.back(); }
  Eigen::Vector2d mean(double from, double to) const {
    return (sum_to(to) - sum_to(from)) / (to - from);
  }

 private:
  /// Integral of the place over the arc up to `at`.
  Eigen::Vector2d sum_to(double at) const {
    const auto above = std::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, at);
    const auto k = static_cast<std::size_t>(above - lengths_.begin());
    const double side = lengths_[k] - lengths_[k - 1], along = at - lengths_[k - 1];
    const Eigen::Vector2d end = points_[k - 1] + along / side * (points_[k] - points_[k - 1]);
    return sums_[k - 1] + 0.5 * along * (points_[k - 1] + end);
  }

  Polygon points_, sums_{Eigen::Vector2d::Zero()};
  std::vector<double> lengths_{0.0};
};

Polygon piece_of(const Polygon& border, std::size_t first, std::size_t last) {
  Polygon points{border[first]};
  do {
    first = (first + 1) % border.size();
    points.push_back(border[first]);
  } while (first != last);
  return points;
}

}  // namespace

outline::Outline outline_of(std::vector<Polygon> borders) {
  const auto largest =
      std::max_element(borders.begin(), borders.end(), [](const Polygon& a, const Polygon& b) {
        return outline::area_px2(a) < outline::area_px2(b);
      });
  outline::Outline outline{std::move(*largest), {}};
  borders.erase(largest);
  outline.holes = std::move(borders);
  return outline;
}

std::vector<std::size_t> sharp_corners(const Polygon& border, double tolerance) {
  constexpr double kSharp_rad = 0.7;
  const std::vector<std::size_t> coarse = outline_corners(border, tolerance);
  std::vector<std::size_t> sharp;
  for (std::size_t i = 0, n = coarse.size(); i < n; ++i) {
    const Eigen::Vector2d& at = border[coarse[i]];
    const Eigen::Vector2d in = at - border[coarse[(i + n - 1) % n]];
    const Eigen::Vector2d out = border[coarse[(i + 1) % n]] - at;
    const double turn = std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));
    if (std::abs(turn) >= kSharp_rad) sharp.push_back(coarse[i]);
  }
  return sharp;
}

Polygon evened_piece(const Polygon& piece, double spacing, int fewest) {
  const Arc arc(piece);
  const int sides = std::max(fewest, static_cast<int>(std::lround(arc.length() / spacing)));
  const double step = arc.length() / sides;
  Polygon inner;
  for (int k = 1; k < sides; ++k) inner.push_back(arc.mean((k - 0.5) * step, (k + 0.5) * step));
  return inner;
}

Polygon evened_border(const Polygon& border, double spacing) {
  std::vector<std::size_t> stops = sharp_corners(border, spacing / 3.0);
  if (stops.empty()) stops.push_back(0);
  const int fewest = stops.size() == 1 ? 3 : stops.size() == 2 ? 2 : 1;
  Polygon result;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const Polygon piece = piece_of(border, stops[i], stops[(i + 1) % stops.size()]);
    const Polygon inner = evened_piece(piece, spacing, fewest);
    result.push_back(border[stops[i]]);
    result.insert(result.end(), inner.begin(), inner.end());
  }
  return result;
}

}  // namespace weft::mesh
