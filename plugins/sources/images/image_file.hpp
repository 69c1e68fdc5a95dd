// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <weft/core/result.hpp>

#include "common/cameras/calibrated_camera.hpp"

namespace weft::images {

/// Reads an image of the camera, of 8 bits a channel: grey or BGR, without its alpha channel, and
/// as stored (an orientation tag does not turn it, since the camera's calibration did not either).
Result<cv::Mat> read_image_file(const std::string& path, const cameras::CalibratedCamera& camera);

}  // namespace weft::images
