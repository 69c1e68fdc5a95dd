// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/sdk/solver.hpp>

#include "energy.hpp"
#include "mesh/mesh_model.hpp"

namespace weft::gauss_newton {

/// The kinds of observations that a solver uses.
enum class Data { matches, sightlines, both };

struct ObservationOptions {
  Data data = Data::matches;          ///< [] matches: where they are wired, else sightlines
  double match_noise_px = 1.0;        ///< [] px, of a match without a covariance
  double covariance_noise_px = 0.25;  ///< [] px, beside the covariance of a match that has one
  double sightline_noise_px = 1.0;    ///< [] px, of a weight of 1
};

/// Reads matches and sightlines and sorts them by face. Excludes those in faces that a visibility
/// marks as completely hidden.
class ObservationReader {
 public:
  /// Fails on indices that the mesh lacks, on numbers that are not finite and on covariances that
  /// are none. Allocates only for
  /// more observations than before.
  Result<void> read(const SolverInput& in, const MeshModel& mesh, const ObservationOptions& options,
                    FrameData& frame);

 private:
  struct Read {
    std::int32_t face = 0;
    Observation seen;
  };

  Result<void> add_matches(const Correspondences& matches, const MeshModel& mesh,
                           const ObservationOptions& options);
  Result<void> add_sightlines(const Sightlines& lines, const MeshModel& mesh, double noise_px);
  void add(std::int32_t face, const Observation& seen) {
    if (hidden_.empty() || hidden_[static_cast<std::size_t>(face)] == 0)
      read_.push_back({face, seen});
  }
  void sort(const MeshModel& mesh, FrameData& frame);

  std::vector<Read> read_;
  std::vector<std::uint8_t> hidden_;  ///< [F] 1 for faces that are; empty without a visibility
  std::vector<std::size_t> next_;     ///< [F+1] where the next observation of a face goes
};

/// Sightlines for a solver that takes no matches: in each face its most central observation.
Sightlines sightlines_of(const FrameData& frame, const Faces& faces);

}  // namespace weft::gauss_newton
