// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

#include "lab/calibration/calibrate.hpp"

namespace weft::calibration {

/// A PNG of the image plane with a line from each detected corner to its projection by the camera.
/// The lines are enlarged so that the longest ones are visible; a bar shows the scale.
Result<std::string> residual_picture(const Calibration& calibration);

}  // namespace weft::calibration
