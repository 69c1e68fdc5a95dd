// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <weft/core/result.hpp>

#include "common/cameras/camera_file.hpp"

namespace weft::cameras {

/// How the images of a camera are stored: the grid of the sensor, and the EXIF orientation (1 to 8)
/// by which they are made upright.
struct StoredImages {
  cv::Size size_px;
  int orientation = 1;
};

struct UprightCamera {
  CameraFile file;
  bool is_rotated = false;  ///< with the images; else the file describes the upright ones
};

/// The camera of images that are made upright. A camera file describes the grid of the sensor, so
/// the camera is rotated with the images. A camera that has only the size of the upright images
/// stays as it is. Fails on another size, and on orientations that mirror, because no rotation of a
/// camera mirrors. The message names `camera_path` and the image `name`.
Result<UprightCamera> upright_camera(const CameraFile& camera, const std::string& camera_path,
                                     const StoredImages& stored, const std::string& name);

}  // namespace weft::cameras
