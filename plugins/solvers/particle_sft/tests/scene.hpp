// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

#include "common/tests/sightline_scene.hpp"
#include "mesh_model.hpp"
#include "relaxation.hpp"

namespace weft::particle_sft {

inline constexpr const char* kId = "solvers/particle_sft";
inline constexpr std::uint64_t kSeed = 20240917;

using solvers::BentPose;
using solvers::known_points;
using solvers::reference_camera;
using solvers::reference_poses;
using solvers::reference_sheet;
using solvers::shape_of;
using Scene = solvers::SightlineScene;

/// The constraints without the plugin around them.
inline ParticleSystem system_of(const Scene& scene) {
  ParticleSystem system;
  MeshModel mesh;
  if (!mesh.build(scene.templ, 0.0)) throw std::runtime_error("the template is no mesh");
  system.stretch = mesh.stretch();
  system.bending = mesh.bending();
  for (std::int64_t i = 0; i < scene.lines.count(); ++i) {
    const double* ray = scene.lines.ray.row(i);
    const std::int32_t v = scene.lines.vertex(i);
    system.rays.push_back({{v, v, v}, {1.0, 0.0, 0.0}, {ray[0], ray[1], ray[2]}, 1.0});
  }
  return system;
}

}  // namespace weft::particle_sft
