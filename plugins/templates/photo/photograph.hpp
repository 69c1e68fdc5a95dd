// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <weft/core/result.hpp>
#include <weft/geometry/camera_model.hpp>

#include "common/cameras/camera_file.hpp"

namespace weft::photo {

/// A photograph and the camera that took it. "Ideal px" are those of the pinhole with the same fx,
/// fy, cx, cy: the photograph without its distortion.
struct Photograph {
  cv::Mat pixels;                ///< [H,W] grey u8 or [H,W,3] BGR u8, upright
  cameras::CameraFile camera{};  ///< a guess unless it is calibrated
  bool is_calibrated = false;
  int orientation = 1;  ///< orientation in the file, by which it was made upright

  Pinhole pinhole() const {
    return {camera.camera.fx, camera.camera.fy, camera.camera.cx, camera.camera.cy};
  }
  /// Where the photograph shows what the ideal pinhole has at a pixel, px.
  Eigen::Vector2d seen_at(const Eigen::Vector2d& ideal_px) const {
    return cameras::seen_px(camera, ideal_px);
  }
};

/// Reads a photograph and turns it upright by its EXIF data. With an empty `camera_path` the focal
/// length is a guess: 0.8 times the longer side, between those of phones (0.75) and webcams. Fails,
/// with file and fix, on a file that is not a photograph and on a camera of another size.
Result<Photograph> read_photograph(const std::string& path, const std::string& camera_path);

/// The photograph's colours as L*a*b* [H,W,3] u8, all three about 0 to 255.
cv::Mat lab_of(const cv::Mat& pixels);

}  // namespace weft::photo
