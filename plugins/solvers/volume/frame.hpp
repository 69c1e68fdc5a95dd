// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/sdk/solver.hpp>

#include "common/seen/seen_points.hpp"
#include "energy.hpp"
#include "solid_model.hpp"

namespace weft::volume {

struct FrameOptions {
  double match_noise_px = 1.0;        ///< [] px, of a match without a covariance
  double covariance_noise_px = 0.25;  ///< [] px, beside the covariance of a match that has one
  double known_radius_m = 0.005;      ///< [] m, radius of known points that have none
  int min_matches = 12;               ///< []
};

/// The measurements of one frame.
class Frame {
 public:
  FrameOptions options;
  FrameData data;
  std::vector<solvers::SeenPoint> seen;  ///< the observations on the surface's vertices
  std::vector<std::uint8_t> observed;    ///< [V] 1 for vertices of faces with an observation

  /// Reads kept matches and known points. Fails on indices that the template lacks, on numbers that
  /// are not finite and on invalid covariances. Returns no_result for too few matches and for
  /// matches on a line of the image.
  Result<void> read(const SolverInput& in, const SolidModel& body);

 private:
  Result<void> read_matches(const Correspondences& matches, const SolidModel& body);
  Result<void> read_known(const KnownPoints& known, const Template& templ, const SolidModel& body);
};

}  // namespace weft::volume
