// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/data/sightlines.hpp>
#include <weft/geometry/camera_model.hpp>

#include "mesh_model.hpp"
#include "relaxation.hpp"

namespace weft::particle_sft {

/// How well a shape explains the sightlines and keeps the lengths.
struct Fit {
  double residual_px = 0.0;  ///< [] px, median distance of the seen points to their rays
  double strain = 0.0;       ///< [] mean |l / l0 - 1| over the edges
  double crease = 0.0;       ///< [] 95th percentile of |l / l0 - 1| over the edges
  double energy = 0.0;       ///< [] mean trust (residual / 0.5 px)^2 + mean (strain / 0.02)^2
  bool mirrored = false;     ///< most seen faces turn the other way than in the image
};

/// Residuals are infinite for points that are not in front of the camera.
Fit assess(const MeshModel& mesh, const ParticleSystem& system, const Sightlines& sightlines,
           const Pinhole& camera, const Points3& vertices_m);

/// The sightlines that count, of a mesh that they fit.
std::vector<RayConstraint> ray_constraints(const Sightlines& lines, const Faces& faces);

/// The point that a ray constraint holds.
Eigen::Vector3d seen_point_m(const RayConstraint& seen, const Points3& vertices_m);

/// How far a shape is from where the object is seen now.
struct ImageMotion {
  double moved_px = 0.0;  ///< [] px, between the means of measured and projected points; infinite
                          ///< if one of them is not in front of the camera
  double apart_px = 0.0;  ///< [] px, mean distance between measured and projected points
  double diagonal_px = 0.0;  ///< [] px, of the bounding box of the measured points
};

ImageMotion image_motion(const ParticleSystem& system, const Pinhole& camera,
                         const Points3& vertices_m);

/// Mirrors the depths of all vertices at the mean depth, each on its own ray: the other shape that
/// looks alike from far away. Vertices that would not be in front of the camera stay.
Points3 depth_mirrored(const Points3& vertices_m);

}  // namespace weft::particle_sft
