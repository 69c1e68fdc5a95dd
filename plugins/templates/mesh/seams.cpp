// SPDX-License-Identifier: Apache-2.0
#include "seams.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "chart_border.hpp"

namespace weft::mesh {
namespace {

using outline::PlaneMesh;
using outline::Polygon;

/// Vertices on a seam that are closer than this share of the seam are one.
constexpr double kSameAlong = 1e-6;

std::pair<std::int32_t, std::int32_t> edge_between(std::int32_t a, std::int32_t b) {
  return std::minmax(a, b);
}

/// The segment of an ascending list that contains a value, and the share of it before the value.
std::pair<std::size_t, double> segment_at(const std::vector<double>& along_m, double at_m) {
  const auto above = std::upper_bound(along_m.begin() + 1, along_m.end() - 1, at_m);
  const auto k = static_cast<std::size_t>(above - along_m.begin());
  return {k - 1, (at_m - along_m[k - 1]) / (along_m[k] - along_m[k - 1])};
}

/// Where a vertex of a border is on the seam.
double along_at(const Eigen::RowVector2d& at, const Eigen::Vector2d& from,
                const Eigen::Vector2d& to, double from_m, double to_m) {
  const Eigen::Vector2d side = to - from;
  const double share = std::clamp(side.dot(at.transpose() - from) / side.squaredNorm(), 0.0, 1.0);
  return from_m + share * (to_m - from_m);
}

}  // namespace

Polygon polygon_along(const Plane& plane, const std::vector<std::int32_t>& vertices) {
  Polygon polygon;
  for (const std::int32_t v : vertices) {
    polygon.emplace_back(plane.chart.mesh.flat_px.row(v).cwiseProduct(plane.scale));
  }
  return polygon;
}

Seams::Seams(const std::vector<Plane>& planes) : planes_(planes) {
  std::map<std::array<double, 3>, std::int32_t> point_at;
  for (const Plane& plane : planes) {
    auto& points = points_.emplace_back();
    for (const auto& row : plane.chart.mesh.vertices_m.rowwise()) {
      const auto own = static_cast<std::int32_t>(dense_m_.size());
      const auto [found, is_new] =
          point_at.try_emplace({row.x() + 0.0, row.y() + 0.0, row.z() + 0.0}, own);
      if (is_new) dense_m_.emplace_back(row);
      points.push_back(found->second);
    }
  }
  for (std::size_t c = 0; c < planes.size(); ++c) {
    for (const auto& border : planes[c].chart.borders) {
      for (std::size_t i = 0; i < border.size(); ++i) {
        const std::int32_t a = point_of(c, border[i]);
        const std::int32_t b = point_of(c, border[(i + 1) % border.size()]);
        if (++sides_at_[edge_between(a, b)] > 1) has_seam_ = true;
      }
    }
  }
}

bool Seams::is_seam(std::int32_t a, std::int32_t b) const {
  return sides_at_.at(edge_between(a, b)) > 1;
}

std::vector<std::size_t> Seams::stops_of(std::size_t chart,
                                         const std::vector<std::int32_t>& border) const {
  std::vector<std::size_t> stops;
  for (std::size_t i = 0; i < border.size(); ++i) {
    if (is_stop_[to_index(point_of(chart, border[i]))]) stops.push_back(i);
  }
  return stops;
}

/// Ends of seams and sharp corners of either side, and one point of each border without those.
void Seams::mark_stops(double spacing_px) {
  is_stop_.assign(dense_m_.size(), false);
  std::map<std::int32_t, std::array<int, 2>> edges_at;  // counts: borders, seams
  for (const auto& [edge, sides] : sides_at_) {
    for (const std::int32_t point : {edge.first, edge.second}) ++edges_at[point][sides > 1 ? 1 : 0];
  }
  for (const auto& [point, edges] : edges_at) {
    const bool is_passed = (edges[0] == 2 && edges[1] == 0) || (edges[0] == 0 && edges[1] == 2);
    if (!is_passed) is_stop_[to_index(point)] = true;
  }
  for (std::size_t c = 0; c < planes_.size(); ++c) {
    for (const auto& border : planes_[c].chart.borders) {
      for (const std::size_t i :
           sharp_corners(polygon_along(planes_[c], border), spacing_px / 3.0)) {
        is_stop_[to_index(point_of(c, border[i]))] = true;
      }
    }
  }
  for (std::size_t c = 0; c < planes_.size(); ++c) {
    for (const auto& border : planes_[c].chart.borders) {
      if (!stops_of(c, border).empty()) continue;
      std::int32_t least = point_of(c, border.front());
      for (const std::int32_t v : border) least = std::min(least, point_of(c, v));
      is_stop_[to_index(least)] = true;
    }
  }
}

std::pair<std::int32_t, bool> Seams::seam_of(std::vector<std::int32_t> points) {
  const bool is_backwards =
      std::pair(points.back(), points[points.size() - 2]) < std::pair(points.front(), points[1]);
  if (is_backwards) std::reverse(points.begin(), points.end());
  const auto [found, is_new] =
      seam_from_.try_emplace({points[0], points[1]}, static_cast<std::int32_t>(seams_.size()));
  if (is_new) {
    Seam& seam = seams_.emplace_back();
    seam.along_m.push_back(0.0);
    for (std::size_t k = 1; k < points.size(); ++k) {
      const double side_m =
          (dense_m_[to_index(points[k])] - dense_m_[to_index(points[k - 1])]).norm();
      seam.along_m.push_back(seam.along_m.back() + side_m);
    }
    seam.points = std::move(points);
  }
  return {found->second, is_backwards};
}

bool Seams::add_point(std::int32_t seam_number, double along_m) {
  Seam& seam = seams_[to_index(seam_number)];
  const double slack_m = kSameAlong * seam.along_m.back();
  const auto above =
      std::lower_bound(seam.inner.begin(), seam.inner.end(), along_m - slack_m,
                       [](const Point& point, double value) { return point.along_m < value; });
  if (above != seam.inner.end() && above->along_m <= along_m + slack_m) return false;
  const auto [k, share] = segment_at(seam.along_m, along_m);
  const Eigen::RowVector3d place_m = (1.0 - share) * dense_m_[to_index(seam.points[k])] +
                                     share * dense_m_[to_index(seam.points[k + 1])];
  seam.inner.insert(above, {along_m, place_m});
  return true;
}

void Seams::spread(double spacing_m) {
  for (std::size_t s = 0; s < seams_.size(); ++s) {
    const double length_m = seams_[s].along_m.back();
    const int sides =
        std::max(seams_[s].fewest, static_cast<int>(std::lround(length_m / spacing_m)));
    for (int k = 1; k < sides; ++k) add_point(static_cast<std::int32_t>(s), k * length_m / sides);
  }
}

Eigen::RowVector2d Seams::flat_at(const Plane& plane, const Corner& corner, double along_m) const {
  const auto [k, share] = segment_at(seams_[to_index(corner.seam)].along_m, along_m);
  const auto& flat_px = plane.chart.mesh.flat_px;
  return (1.0 - share) * flat_px.row(corner.vertices[k]) +
         share * flat_px.row(corner.vertices[k + 1]);
}

void Seams::add_seam(const Plane& plane, std::vector<std::int32_t> vertices, std::int32_t number,
                     bool is_backwards, Border& border) const {
  if (is_backwards) std::reverse(vertices.begin(), vertices.end());
  const Seam& seam = seams_[to_index(number)];
  Corner& first = border.back();
  first.seam = number;
  first.vertices = std::move(vertices);
  first.along_m = is_backwards ? seam.along_m.back() : 0.0;
  std::vector<Point> inner = seam.inner;
  if (is_backwards) std::reverse(inner.begin(), inner.end());
  for (const Point& point : inner) {
    border.back().next_along_m = point.along_m;
    Corner next = border.back();
    next.along_m = point.along_m;
    next.shared = SharedVertex{point.place_m, flat_at(plane, next, point.along_m)};
    next.in_plane = next.shared->flat_px.cwiseProduct(plane.scale);
    border.push_back(std::move(next));
  }
  border.back().next_along_m = is_backwards ? 0.0 : seam.along_m.back();
}

Seams::Border Seams::border_of(std::size_t chart, const std::vector<std::int32_t>& walk,
                               double spacing_px) {
  const Plane& plane = planes_[chart];
  const std::vector<std::size_t> stops = stops_of(chart, walk);
  const int fewest = stops.size() == 1 ? 3 : stops.size() == 2 ? 2 : 1;
  Border border;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    std::vector<std::int32_t> vertices{walk[stops[i]]}, points{point_of(chart, walk[stops[i]])};
    for (std::size_t k = stops[i]; points.size() == 1 || !is_stop_[to_index(points.back())];) {
      k = (k + 1) % walk.size();
      vertices.push_back(walk[k]), points.push_back(point_of(chart, walk[k]));
    }
    const Polygon piece = polygon_along(plane, vertices);
    Corner corner;
    corner.in_plane = piece.front();
    corner.shared = SharedVertex{dense_m_[to_index(points.front())],
                                 plane.chart.mesh.flat_px.row(vertices.front())};
    border.push_back(std::move(corner));
    if (is_seam(points[0], points[1])) {
      const auto [seam, is_backwards] = seam_of(points);
      seams_[to_index(seam)].fewest = std::max(seams_[to_index(seam)].fewest, fewest);
      add_seam(plane, std::move(vertices), seam, is_backwards, border);
      continue;
    }
    for (const Eigen::Vector2d& at : evened_piece(piece, spacing_px, fewest)) {
      Corner open;
      open.in_plane = at;
      border.push_back(std::move(open));
    }
  }
  return border;
}

bool Seams::add_points_of(const PlaneMesh& mesh, const std::vector<Border>& borders,
                          bool& has_grown) {
  const BorderWalk walk(mesh);
  for (const Border& border : borders) {
    for (std::size_t i = 0; i < border.size(); ++i) {
      const Corner& corner = border[i];
      if (corner.seam < 0) continue;
      const Eigen::Vector2d& to = border[(i + 1) % border.size()].in_plane;
      const auto side = walk.between(corner.in_plane, to);
      if (!side) return false;
      for (std::size_t k = 1; k + 1 < side->size(); ++k) {
        const double along_m = along_at(mesh.flat_px.row((*side)[k]), corner.in_plane, to,
                                        corner.along_m, corner.next_along_m);
        has_grown = add_point(corner.seam, along_m) || has_grown;
      }
    }
  }
  return true;
}

/// The new vertices of the seam between two corners, in the direction of the walk.
std::vector<Seams::Point> Seams::points_behind(const Corner& corner) const {
  const Seam& seam = seams_[to_index(corner.seam)];
  const double slack_m = kSameAlong * seam.along_m.back();
  const auto [low_m, high_m] = std::minmax(corner.along_m, corner.next_along_m);
  std::vector<Point> points;
  for (const Point& point : seam.inner) {
    if (point.along_m > low_m + slack_m && point.along_m < high_m - slack_m) {
      points.push_back(point);
    }
  }
  if (corner.next_along_m < corner.along_m) std::reverse(points.begin(), points.end());
  return points;
}

/// Gives the vertices of a side that are on a seam their places, and adds those that only the other
/// side of the seam has.
void Seams::share_side(const Plane& plane, const Corner& corner,
                       const std::vector<std::int32_t>& side, const std::vector<double>& along_m,
                       ChartMesh& mesh) const {
  const double slack_m = kSameAlong * seams_[to_index(corner.seam)].along_m.back();
  const double sign = corner.next_along_m < corner.along_m ? -1.0 : 1.0;
  std::size_t k = 0;
  std::int32_t from = side.front();
  double from_m = along_m.front();
  for (const Point& point : points_behind(corner)) {
    while (sign * (along_m[k + 1] - point.along_m) < -slack_m) {
      ++k, from = side[k], from_m = along_m[k];
    }
    std::int32_t vertex = side[k + 1];
    if (std::abs(along_m[k + 1] - point.along_m) > slack_m) {
      const double share = (point.along_m - from_m) / (along_m[k + 1] - from_m);
      vertex = split_side(mesh.plane, from, vertex, share);
      from = vertex, from_m = point.along_m;
    }
    mesh.shared[vertex] = {point.place_m, flat_at(plane, corner, point.along_m)};
  }
}

bool Seams::share(const Plane& plane, const std::vector<Border>& borders, ChartMesh& mesh) const {
  // Vertices that are added have higher numbers and do not change those of the walk.
  const PlaneMesh as_filled = mesh.plane;
  const BorderWalk walk(as_filled);
  for (const Border& border : borders) {
    for (std::size_t i = 0; i < border.size(); ++i) {
      const Corner& corner = border[i];
      if (corner.shared) {
        const auto own = walk.vertex(corner.in_plane);
        if (!own) return false;
        mesh.shared[*own] = *corner.shared;
      }
      if (corner.seam < 0) continue;
      const Eigen::Vector2d& to = border[(i + 1) % border.size()].in_plane;
      const auto side = walk.between(corner.in_plane, to);
      if (!side) return false;
      std::vector<double> along_m;
      for (const std::int32_t v : *side) {
        along_m.push_back(along_at(as_filled.flat_px.row(v), corner.in_plane, to, corner.along_m,
                                   corner.next_along_m));
      }
      share_side(plane, corner, *side, along_m, mesh);
    }
  }
  return true;
}

/// The borders of a chart with edges of this length, and the chart filled within them.
std::optional<PlaneMesh> Seams::fill_chart(std::size_t chart, double spacing_px,
                                           int smoothing_rounds, std::vector<Border>& borders) {
  std::vector<Polygon> polygons;
  for (const auto& walk : planes_[chart].chart.borders) {
    borders.push_back(border_of(chart, walk, spacing_px));
    auto& polygon = polygons.emplace_back();
    for (const Corner& corner : borders.back()) polygon.push_back(corner.in_plane);
  }
  auto mesh = fill_outline(outline_of(std::move(polygons)), spacing_px, smoothing_rounds);
  if (!mesh || mesh->faces.rows() == 0) return std::nullopt;
  return *std::move(mesh);
}

std::vector<ChartMesh> Seams::fill(double spacing_px, double unit_m, int smoothing_rounds) {
  constexpr int kRounds = 4;  // in which either side's additional vertices go to the other one
  seams_.clear(), seam_from_.clear();
  mark_stops(spacing_px);
  // The first pass finds the seams, on which vertices are spread then.
  for (std::size_t c = 0; c < planes_.size(); ++c) {
    for (const auto& walk : planes_[c].chart.borders) border_of(c, walk, spacing_px);
  }
  spread(spacing_px * unit_m);
  for (int round = 0;; ++round) {
    std::vector<ChartMesh> meshes;
    std::vector<std::vector<Border>> borders;
    for (std::size_t c = 0; c < planes_.size(); ++c) {
      auto mesh = fill_chart(c, spacing_px, smoothing_rounds, borders.emplace_back());
      if (!mesh) return {};
      meshes.push_back({*std::move(mesh)});
    }
    bool has_grown = false;
    for (std::size_t c = 0; c < planes_.size(); ++c) {
      if (!add_points_of(meshes[c].plane, borders[c], has_grown)) return {};
    }
    if (has_grown && round < kRounds) continue;
    for (std::size_t c = 0; c < planes_.size(); ++c) {
      if (!share(planes_[c], borders[c], meshes[c])) return {};
    }
    return meshes;
  }
}

}  // namespace weft::mesh
