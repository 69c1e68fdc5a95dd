// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <weft/data/camera.hpp>

namespace weft {

/// An impossible value in a camera.
struct CameraMistake {
  std::string field;    ///< name of the field in camera/1: "fx", "cx", "width"
  std::string message;  ///< message with the legal range
};

/// The first illegal number of a camera, if there is one. Legal ranges in px:
///   width, height   1 to 65535
///   fx, fy          0.01 to 1e7, and fx / fy 0.1 to 10
///   cx, cy          at most one image size beyond the image: -width to 2 width
inline std::optional<CameraMistake> camera_mistake(const Camera& camera) {
  constexpr double kMostPixels = 65535.0, kLeastFocal_px = 0.01, kMostFocal_px = 1e7, kRatio = 10.0;
  const auto outside = [](const char* field, double value, double low, double high,
                          const std::string& unit) -> std::optional<CameraMistake> {
    if (value >= low && value <= high) return std::nullopt;  // false for NaN
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text.precision(10);
    text << "'" << field << "' is " << value << ", legal is " << low << " to " << high << unit;
    return CameraMistake{field, text.str()};
  };
  const auto width = static_cast<double>(camera.width_px);
  const auto height = static_cast<double>(camera.height_px);
  std::optional<CameraMistake> mistake;
  const auto first = [&](std::optional<CameraMistake> found) {
    if (!mistake) mistake = std::move(found);
  };
  first(outside("width", width, 1.0, kMostPixels, " px"));
  first(outside("height", height, 1.0, kMostPixels, " px"));
  first(outside("fx", camera.fx, kLeastFocal_px, kMostFocal_px, " px"));
  first(outside("fy", camera.fy, kLeastFocal_px, kMostFocal_px, " px"));
  first(outside("fy", camera.fy, camera.fx / kRatio, camera.fx * kRatio,
                " px: pixels are nowhere ten times as wide as high"));
  first(outside("cx", camera.cx, -width, 2.0 * width, " px: at most one width beyond the image"));
  first(
      outside("cy", camera.cy, -height, 2.0 * height, " px: at most one height beyond the image"));
  return mistake;
}

}  // namespace weft
