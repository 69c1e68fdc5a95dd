// SPDX-License-Identifier: Apache-2.0
#include "rim.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::solvers {
namespace {

constexpr double kLeastCell_px = 2.0, kMostCells = 400.0;
constexpr double kStep = 2.0;     // cells between points
constexpr double kBeyond = 1.6;   // cells from an edge to where nothing of the mesh may be
constexpr double kFlat_px = 0.5;  // shorter edges have no direction

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

void RimFinder::prepare(const Faces& faces, Eigen::Index vertex_count) {
  faces_ = faces;
  places_px_.resize(to_index(vertex_count));
  sides_.clear();
  std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> side_of;
  for (std::int32_t f = 0; f < faces_.rows(); ++f) {
    for (std::int32_t k = 0; k < 3; ++k) {
      const auto edge = std::minmax({faces_(f, k), faces_(f, (k + 1) % 3)});
      const auto [found, is_new] = side_of.try_emplace(edge, sides_.size());
      if (is_new) {
        sides_.push_back({f, -1, {k, (k + 1) % 3, (k + 2) % 3}});
      } else {
        sides_[found->second].across = f;
      }
    }
  }
}

const std::vector<RimPoint>& RimFinder::find(const Pinhole& camera, double width_px,
                                             double height_px, const Points3& vertices_m,
                                             const std::vector<std::uint8_t>& covered) {
  points_.clear();
  if (!(vertices_m.col(2).minCoeff() > 0.0)) return points_;
  for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
    places_px_[to_index(v)] = project(camera, vertices_m.row(v).transpose());
  }
  fill(width_px, height_px);
  for (const Side& side : sides_) {
    const bool is_border = side.across < 0;
    if (!is_border && !(turn(side.face) * turn(side.across) < 0.0)) continue;
    if (!covered.empty()) {
      const std::int32_t a = faces_(side.face, side.corner[0]);
      const std::int32_t b = faces_(side.face, side.corner[1]);
      if (covered[to_index(a)] != 0 && covered[to_index(b)] != 0) continue;
    }
    add_points(side);
  }
  return points_;
}

double RimFinder::turn(Eigen::Index face) const {
  const auto at = [&](Eigen::Index k) { return places_px_[to_index(faces_(face, k))]; };
  return cross(at(1) - at(0), at(2) - at(0));
}

void RimFinder::fill(double width_px, double height_px) {
  cell_px_ = std::max(kLeastCell_px, std::max(width_px, height_px) / kMostCells);
  columns_ = static_cast<std::int64_t>(std::ceil(width_px / cell_px_));
  rows_ = static_cast<std::int64_t>(std::ceil(height_px / cell_px_));
  raster_.assign(to_index(columns_ * rows_), 0);
  for (Eigen::Index f = 0; f < faces_.rows(); ++f) fill_face(f);
}

/// Marks the cells whose centres are in the face, row by row.
void RimFinder::fill_face(Eigen::Index face) {
  std::array<Eigen::Vector2d, 3> corner;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int32_t v = faces_(face, static_cast<Eigen::Index>(k));
    corner[k] = places_px_[to_index(v)] / cell_px_;
  }
  const auto [top, bottom] = std::minmax({corner[0].y(), corner[1].y(), corner[2].y()});
  const auto first = static_cast<std::int64_t>(std::ceil(std::max(top, 0.0)));
  const auto last =
      static_cast<std::int64_t>(std::floor(std::min(bottom, static_cast<double>(rows_ - 1))));
  worked(std::max(last - first, std::int64_t{0}));
  for (std::int64_t y = first; y <= last; ++y) {
    double left = 1e300, right = -1e300;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector2d &a = corner[k], &b = corner[(k + 1) % 3];
      const double height = b.y() - a.y(), share = (static_cast<double>(y) - a.y()) / height;
      if (height == 0.0 || !(share >= 0.0 && share <= 1.0)) continue;
      const double x = a.x() + share * (b.x() - a.x());
      left = std::min(left, x);
      right = std::max(right, x);
    }
    left = std::ceil(std::max(left, 0.0));
    right = std::floor(std::min(right, static_cast<double>(columns_ - 1)));
    if (!(left <= right)) continue;
    std::uint8_t* row = raster_.data() + y * columns_;
    std::fill(row + static_cast<std::int64_t>(left), row + static_cast<std::int64_t>(right) + 1,
              std::uint8_t{1});
  }
}

bool RimFinder::is_covered(const Eigen::Vector2d& place_px) const {
  const double x = std::round(place_px.x() / cell_px_), y = std::round(place_px.y() / cell_px_);
  if (!(x >= 0.0 && y >= 0.0 && x < static_cast<double>(columns_) &&
        y < static_cast<double>(rows_)))
    return false;
  return raster_[to_index(static_cast<std::int64_t>(y) * columns_ +
                          static_cast<std::int64_t>(x))] != 0;
}

void RimFinder::add_points(const Side& side) {
  const auto at = [&](std::size_t k) {
    return places_px_[to_index(faces_(side.face, side.corner[k]))];
  };
  const Eigen::Vector2d a = at(0), along = at(1) - a;
  const double length_px = along.norm();
  if (!(length_px > kFlat_px) || !std::isfinite(length_px)) return;
  Eigen::Vector2d outwards(along.y() / length_px, -along.x() / length_px);
  if (outwards.dot(at(2) - a) > 0.0) outwards = -outwards;
  const int count = static_cast<int>(std::min(std::ceil(length_px / (kStep * cell_px_)), 1000.0));
  for (int k = 0; k < count; ++k) {
    const double share = (k + 0.5) / count;
    RimPoint point;
    point.face = side.face;
    point.weights[to_index(side.corner[0])] = 1.0 - share;
    point.weights[to_index(side.corner[1])] = share;
    point.place_px = a + share * along;
    point.outwards = outwards;
    if (!is_covered(point.place_px + kBeyond * cell_px_ * outwards)) points_.push_back(point);
  }
}

}  // namespace weft::solvers
