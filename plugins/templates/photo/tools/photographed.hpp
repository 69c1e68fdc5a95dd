// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core.hpp>

#include "common/cameras/camera_file.hpp"
#include "sheet_view.hpp"

namespace weft::photo {

/// The background below the surface.
enum class Table { plain, wood };

/// A flat surface on a table, and the camera in front of it.
struct Still {
  cv::Mat print;           ///< [H,W,3] BGR u8, on the surface within its margin
  double width_m = 0.297;  ///< width of the surface, margin included
  double height_m = 0.21;
  double margin_m = 0.0;  ///< white paper around the texture
  double paper_grey = 245.0;
  double table_grey = 110.0;
  Table table = Table::plain;
  cameras::CameraFile camera{};
  double distance_m = 0.45;  ///< from the camera to the middle of the surface
  double tilt_rad = 0.0;     ///< tilt of the surface about its horizontal axis, the upper side
                             ///< going away
  double turn_rad = 0.0;     ///< about its vertical axis, before
  double roll_rad = 0.0;     ///< about the optical axis, clockwise, after both
  Eigen::Vector2d aside_m = Eigen::Vector2d::Zero();  ///< offset of its middle from the optical
                                                      ///< axis
  double noise_grey = 1.5;
  std::uint64_t seed = 1;  ///< seed of the noise
};

/// The image of the camera: each pixel is the mean of 3 x 3 places in it; BGR.
cv::Mat photographed(const Still& still);

/// The surface's corners in px of the ideal pinhole, or of the photograph.
Corners true_corners(const Still& still);
Corners true_corners_seen(const Still& still);

/// `width` x `height` px, a focal length of 0.86 times the width, the principal point beside the
/// middle, and a lens that bends straight lines (brown, k1 = -0.12) or none.
cameras::CameraFile make_camera(int width, int height, bool with_lens);

}  // namespace weft::photo
