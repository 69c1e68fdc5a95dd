// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/sdk/solver.hpp>

#include "mesh_model.hpp"
#include "relaxation.hpp"

namespace weft::particle_sft {

// With less than this a shape is weak ...
inline constexpr int kManyMatches = 30;
// ... and with less than this it is lost.
inline constexpr int kFewMatches = 10;

struct FrameOptions {
  double known_radius_m = 0.005;     ///< [] m, of known points whose own is negative
  int min_sightlines = 3;            ///< []
  bool continue_hidden_bend = true;  ///< []
};

/// What holds the shape in one frame.
struct FrameConstraints {
  ParticleSystem system;             ///< its bending pairs are those of each start
  std::vector<std::uint8_t> hidden;  ///< [V] 1 for the hidden part; empty without one
  int matches = 0;                   ///< [] kept; `kManyMatches` where none are wired
  int inconsistent_pairs = 0;        ///< [] of known points

  /// Fills the rays and spheres; no result where too little is seen.
  Result<void> read(const SolverInput& in, const MeshModel& mesh, const FrameOptions& options);

 private:
  Result<void> count_matches(const SolverInput& in);
};

}  // namespace weft::particle_sft
