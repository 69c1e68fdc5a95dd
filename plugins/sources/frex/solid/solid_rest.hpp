// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>

namespace weft::frex {

/// A surface with vertices within its faces, where the truth has points, and with short edges.
struct RefinedSurface {
  Points3 places_m;           ///< [R,3] m: the V vertices, the F centres of the faces, others
  Points2 uv_px;              ///< [R,2] px of the texture, linear on each of the F faces
  Faces faces;                ///< [S,3]
  Eigen::Index truth_points;  ///< [] V + F
  Faces truth_faces;          ///< [3F,3] the faces, each divided in three at its centre
};

/// Divides the faces until no edge is longer than `edge_m`. Faces at an edge divide it in the same
/// way, also when they are on two sides of a seam. Fails if the surface would become too large.
Result<RefinedSurface> refined(const Points3& places_m, const Points2& uv_px, const Faces& faces,
                               double edge_m);

/// A solid object at rest.
struct SolidRest {
  RefinedSurface surface;      ///< in the frame of its bounding box: x along the longest side, z
                               ///< along the shortest one and away from the camera
  Eigen::RowVector2d pitch_m;  ///< [2] m, size of a texel
  Eigen::Vector3d size_m;      ///< [3] m, extent along x, y, z
};

/// The solid inside a template's surface. `edge_m` 0 is a fortieth of its diagonal. Fails without
/// m_per_px. An open surface becomes a solid without volume, with its textured side towards the
/// camera.
Result<SolidRest> solid_of(const Template& object, double edge_m);

}  // namespace weft::frex
