// SPDX-License-Identifier: Apache-2.0
#include "chart_border.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <weft/geometry/barycentric.hpp>

namespace weft::mesh {
namespace {

using outline::PlaneMesh;
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

BorderWalk::BorderWalk(const PlaneMesh& mesh) : mesh_(mesh) {
  for (std::int32_t v = 0; v < mesh.flat_px.rows(); ++v) {
    vertex_at_.emplace(std::pair(mesh.flat_px(v, 0), mesh.flat_px(v, 1)), v);
  }
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) walks_.emplace(mesh.faces(f, k), mesh.faces(f, (k + 1) % 3));
  }
}

std::optional<std::int32_t> BorderWalk::vertex(const Eigen::Vector2d& at) const {
  const auto found = vertex_at_.find({at.x(), at.y()});
  return found == vertex_at_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::vector<std::int32_t>> BorderWalk::between(const Eigen::Vector2d& from,
                                                             const Eigen::Vector2d& to) const {
  const auto first = vertex(from), last = vertex(to);
  if (!first || !last) return std::nullopt;
  std::vector<std::int32_t> side{*first};
  while (side.back() != *last) {
    const auto next = next_towards(side.back(), to);
    if (!next || side.size() > walks_.size()) return std::nullopt;
    side.push_back(*next);
  }
  return side;
}

/// The end of the border's edge from a vertex that leads straight to a point.
std::optional<std::int32_t> BorderWalk::next_towards(std::int32_t vertex,
                                                     const Eigen::Vector2d& to) const {
  constexpr double kStraight = 0.999;
  const Eigen::Vector2d at = mesh_.flat_px.row(vertex);
  double best = kStraight;
  std::optional<std::int32_t> next;
  for (auto walk = walks_.lower_bound({vertex, 0}); walk != walks_.end() && walk->first == vertex;
       ++walk) {
    if (walks_.contains({walk->second, vertex})) continue;
    const Eigen::Vector2d ahead = mesh_.flat_px.row(walk->second).transpose() - at;
    const double cosine = ahead.normalized().dot((to - at).normalized());
    if (cosine > best) best = cosine, next = walk->second;
  }
  return next;
}

std::int32_t split_side(PlaneMesh& mesh, std::int32_t from, std::int32_t to, double share) {
  const auto added = static_cast<std::int32_t>(mesh.flat_px.rows());
  mesh.flat_px.conservativeResize(added + 1, 2);
  mesh.flat_px.row(added) = (1.0 - share) * mesh.flat_px.row(from) + share * mesh.flat_px.row(to);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (mesh.faces(f, k) != from || mesh.faces(f, (k + 1) % 3) != to) continue;
      const Eigen::Index last = mesh.faces.rows();
      mesh.faces.conservativeResize(last + 1, 3);
      mesh.faces.row(last) << added, to, mesh.faces(f, (k + 2) % 3);
      mesh.faces(f, (k + 1) % 3) = added;
      return added;
    }
  }
  return added;
}

}  // namespace weft::mesh
