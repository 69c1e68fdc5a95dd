// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/types.hpp>

namespace weft::solvers {

/// A point of the rim of a shape in the image.
struct RimPoint {
  std::int32_t face = 0;
  std::array<double, 3> weights{};  ///< [3] in the face, sum 1
  Eigen::Vector2d place_px;         ///< on the edge of the mesh
  Eigen::Vector2d outwards;         ///< unit normal of the edge, away from the surface
};

/// Finds the rim of a shape. It consists of border edges of the mesh and of edges between a face
/// that shows its front and one that shows its back. No part of the mesh is beyond them in the
/// image.
class RimFinder {
 public:
  /// Structure for a mesh of faces [F,3] without an edge of three.
  void prepare(const Faces& faces, Eigen::Index vertex_count);

  /// The rim of a shape [V,3] in an image of this size, in points at distances of 4 px, or
  /// more in large images. `covered` [V] is 1 for vertices that something hides; edges between them
  /// are omitted. It may be empty. Empty if a vertex is not in front of the camera.
  const std::vector<RimPoint>& find(const Pinhole& camera, double width_px, double height_px,
                                    const Points3& vertices_m,
                                    const std::vector<std::uint8_t>& covered);

 private:
  /// An edge of the mesh as a side of a face, and the face across it.
  struct Side {
    std::int32_t face = 0, across = -1;    ///< across: -1 on the border
    std::array<std::int32_t, 3> corner{};  ///< corners of the face: both ends, the opposite one
  };

  void fill(double width_px, double height_px);
  void fill_face(Eigen::Index face);
  bool is_covered(const Eigen::Vector2d& place_px) const;
  double turn(Eigen::Index face) const;  ///< px^2, twice the signed area in the image
  void add_points(const Side& side);

  Faces faces_;
  std::vector<Side> sides_;
  std::vector<Eigen::Vector2d> places_px_;  ///< [V]
  std::vector<std::uint8_t> raster_;        ///< 1 where the mesh covers a cell
  double cell_px_ = 2.0;
  std::int64_t columns_ = 0, rows_ = 0;
  std::vector<RimPoint> points_;
};

}  // namespace weft::solvers
