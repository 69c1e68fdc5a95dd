// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/cameras/camera_file.hpp"
#include "common/cameras/camera_values.hpp"

namespace weft::cameras {

/// Where a program writes the numbers of a camera. Paths are separated by '|'; the first that is
/// there counts.
struct Format {
  std::string title;      ///< "an OpenCV or ROS calibration"
  std::string signature;  ///< a path that no other format has
  /// fx, fy, cx and cy; or one path of a 3 x 3 matrix or of a list of these four.
  std::array<std::string, 4> pinhole;
  std::array<std::string, 2> size;  ///< width and height, or one path of a list of both
  std::string model;                ///< the lens model
  std::string coefficients;         ///< a list, or else
  std::optional<std::string> each;  ///< the prefix of k1, k2, p1, ... where each has its own key
  /// Coordinates of the centre of the first pixel: 0 for OpenCV, 0.5 for COLMAP.
  double first_centre = 0.0;
  bool metashape = false;  ///< XML, with cx and cy from the middle of the image
};

/// The formats that are read besides Weft's own and COLMAP's cameras.txt, in the order in which
/// they are tried.
const std::vector<Format>& known_formats();
const Format& own_format();

/// The program whose files have these values but cannot be read; nothing where it is unknown.
std::optional<std::string> unread_format(const CameraValues& values);

/// The same of a text that is neither YAML nor JSON nor XML, or of bytes that are no text.
std::optional<std::string> unread_text(std::string_view text);

/// "write its numbers into a camera file with the keys ...": what helps with any other file.
std::string keys_to_write();

/// A lens model by the name that a program gives it, in any case.
struct Lens {
  std::string_view name;
  Distortion model;
  bool only_zeros = false;  ///< other coefficients mean what Weft's models cannot represent
};
std::optional<Lens> lens_named(std::string name);

}  // namespace weft::cameras
