// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/cameras/camera_file.hpp"
#include "common/cameras/camera_formats.hpp"
#include "common/cameras/camera_values.hpp"

namespace weft::cameras {

/// The camera that the values of a file describe, in Weft's own format or a known one. Throws
/// FileMistake.
CameraFile read_camera(const CameraValues& values);

/// The same of values below a path, such as "cam0/", in a format.
CameraFile read_format(const CameraValues& values, const Format& format, const std::string& prefix);

/// The camera of CameraValues::of_colmap(). Throws FileMistake.
CameraFile read_colmap(const CameraValues& values);

}  // namespace weft::cameras
