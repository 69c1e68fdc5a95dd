// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "common/plane_mesh.hpp"
#include "common/polygon.hpp"

namespace weft::mesh {

/// A border with corners at distances of about `spacing`. Sharp corners of the outline that keeps
/// within a third of that stay where they are (D. H. Douglas, T. K. Peucker, Algorithms for the
/// reduction of the number of points, 1973). Between them, corners are at equal distances along the
/// border. Each is at the mean of the border half a spacing to both sides, which smooths finer
/// detail.
outline::Polygon evened_border(const outline::Polygon& border, double spacing);

/// The outline with these borders, in any order: that of the largest area goes around the others.
outline::Outline outline_of(std::vector<outline::Polygon> borders);

/// Corners of the outline that keeps within `tolerance` at which it turns sharply, ascending.
std::vector<std::size_t> sharp_corners(const outline::Polygon& border, double tolerance);

/// The corners between the ends of a piece of a border, as in evened_border(), in at least `fewest`
/// sides.
outline::Polygon evened_piece(const outline::Polygon& piece, double spacing, int fewest);

/// Follows the border of a mesh from corner to corner of its outline. The mesh must outlive it.
class BorderWalk {
 public:
  explicit BorderWalk(const outline::PlaneMesh& mesh);

  /// The vertex at exactly this place.
  std::optional<std::int32_t> vertex(const Eigen::Vector2d& at) const;
  /// The vertices from one corner to another one on the straight side between them, both included;
  /// nothing where the mesh has no such side.
  std::optional<std::vector<std::int32_t>> between(const Eigen::Vector2d& from,
                                                   const Eigen::Vector2d& to) const;

 private:
  std::optional<std::int32_t> next_towards(std::int32_t vertex, const Eigen::Vector2d& to) const;

  const outline::PlaneMesh& mesh_;
  std::map<std::pair<double, double>, std::int32_t> vertex_at_;
  std::set<std::pair<std::int32_t, std::int32_t>> walks_;  ///< sides of faces, as these walk them
};

/// Adds a vertex on an edge of the border, and gives its number; the face walks from `from` to
/// `to`.
std::int32_t split_side(outline::PlaneMesh& mesh, std::int32_t from, std::int32_t to, double share);

}  // namespace weft::mesh
