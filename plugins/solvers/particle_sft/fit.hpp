// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/data/sightlines.hpp>
#include <weft/geometry/camera_model.hpp>

#include "common/image_motion.hpp"
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

/// How far a shape is from where the rays see the object.
solvers::ImageMotion image_motion(const ParticleSystem& system, const Pinhole& camera,
                                  const Points3& vertices_m);

}  // namespace weft::particle_sft
