// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/commands.hpp"

namespace weft::cli {

/// The focal length of a film's camera, estimated from its frames.
struct FocalMeasurement {
  double by_side = 0.0;     ///< [] focal length divided by the longer side of the frames
  double by_side_sd = 0.0;  ///< [] its standard deviation
  int frames = 0;           ///< unlike frames that were used
};

/// Runs a pipeline whose camera is assumed, with these settings, and reads the focal length from
/// the set-up monitor. Nothing if the pipeline cannot run, if it was interrupted, or if the
/// standard deviation is above 6 %: the assumed one is as good then. `scratch` is a run folder that
/// is removed.
std::optional<FocalMeasurement> measure_focal(const std::string& pipeline,
                                              const std::vector<std::string>& settings,
                                              const std::string& scratch, Context& context);

}  // namespace weft::cli
