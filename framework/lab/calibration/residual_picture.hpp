// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

#include "lab/calibration/calibrate.hpp"

namespace weft::calibration {

/// A PNG of the image plane: from each corner as it is seen a line to where the camera puts it,
/// enlarged so that the longest ones can be seen, with a bar that says by how much.
Result<std::string> residual_picture(const Calibration& calibration);

}  // namespace weft::calibration
