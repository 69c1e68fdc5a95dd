// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/sdk/solver.hpp>

#include "mesh_model.hpp"
#include "relaxation.hpp"

namespace weft::particle_sft {

inline constexpr int kFewestMatches = 10;  // with less the object is lost

struct FrameOptions {
  double known_radius_m = 0.005;        ///< [] m, of known points whose own is negative
  int min_sightlines = 3;               ///< []
  bool continue_hidden_bend = true;     ///< []
  bool continue_uncovered_bend = true;  ///< []
};

/// The constraints on the shape in one frame.
struct FrameConstraints {
  ParticleSystem system;             ///< its bending pairs are those of each start
  std::vector<std::uint8_t> hidden;  ///< [V] 1 for the hidden part; empty without one
  int inconsistent_pairs = 0;        ///< [] of known points

  /// Fills the rays and spheres; no result where too little is seen.
  Result<void> read(const SolverInput& in, const MeshModel& mesh, const FrameOptions& options);
};

}  // namespace weft::particle_sft
