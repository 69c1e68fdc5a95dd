// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "common/cameras/camera_file.hpp"

namespace weft::cameras {

/// Resamples images bilinearly as an ideal pinhole with the same fx, fy, cx, cy and size would have
/// seen them. Positions are rounded to 1/32 px. Pixels outside the camera's field of view become
/// black.
class Undistorter {
 public:
  /// Leaves images as they are.
  Undistorter() = default;
  explicit Undistorter(const CameraFile& file);

  bool changes_images() const { return !map_xy_.empty(); }
  /// `image` has the size of the camera; `undistorted` is allocated unless it has size and type.
  void apply(const cv::Mat& image, cv::Mat& undistorted) const;
  /// The same without interpolation, for values that must not be mixed, such as depth. Each pixel
  /// has the value nearest to its source position, and 0 outside the camera's field of view.
  cv::Mat nearest(const cv::Mat& image) const;

 private:
  cv::Mat map_xy_;       // [H,W,2] i16: whole source pixels
  cv::Mat map_weights_;  // [H,W] u16: index of the fraction
};

}  // namespace weft::cameras
