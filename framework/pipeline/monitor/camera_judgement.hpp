// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pipeline/monitor/joint_deviation.hpp"

namespace weft {

/// Deviations of the given camera from the one that took the frames.
struct CameraFault {
  std::string kind;   ///< "focal length"
  std::string claim;  ///< "the focal length seems to be 0.77 (+- 0.02) times the one given"
  std::string text;   ///< the claim with what to do
  bool is_sure;       ///< false where a surface that stretches explains it as well
  double fine;        ///< [] probability that the deviation is too small to matter; below 0.5
};

/// Evidence of all frames together: deviations that matter, by at least four standard deviations.
/// `radius` is that of the farthest match, X / Z.
std::vector<CameraFault> camera_faults(const std::vector<CameraEvidence>& frames,
                                       const Camera& camera, double radius);

}  // namespace weft
