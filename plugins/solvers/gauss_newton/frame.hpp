// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/sdk/solver.hpp>

#include "energy.hpp"
#include "mesh/mesh_model.hpp"
#include "observations.hpp"

namespace weft::gauss_newton {

struct FrameOptions {
  ObservationOptions seen;
  double known_radius_m = 0.005;        ///< [] m, of known points whose own is negative
  int min_sightlines = 3;               ///< [] points seen
  bool continue_hidden_bend = true;     ///< []
  bool continue_uncovered_bend = true;  ///< []
  bool outline_alone = false;           ///< [] where there are too few matches
};

/// The constraints on the shape in one frame.
struct Frame {
  FrameOptions options;
  FrameData data;
  std::vector<std::uint8_t>
      observed;  ///< [V] 1 for vertices that an observation or known point holds
  std::vector<std::uint8_t> hidden;  ///< [V] 1 where the bend of the others goes on; or empty
  int inconsistent_pairs = 0;        ///< [] of known points
  bool is_outline_alone = false;     ///< [] nothing else is seen

  /// No result where too little is seen.
  Result<void> read(const SolverInput& in, const MeshModel& mesh);

 private:
  Result<void> read_mask(const SolverInput& in, const MeshModel& mesh);
  Result<void> read_observations(const SolverInput& in, const MeshModel& mesh);
  Result<void> find_hidden(const SolverInput& in, const MeshModel& mesh);

  ObservationReader reader_;
};

}  // namespace weft::gauss_newton
