// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lab/calibration/calibrate.hpp"

namespace weft::calibration {

/// A camera file as sources read it, with standard deviations and the error of each view under
/// `calibration`.
std::string camera_text(const Calibration& calibration);

}  // namespace weft::calibration
