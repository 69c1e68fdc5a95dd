// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <weft/core/result.hpp>
#include <weft/geometry/camera_model.hpp>

namespace weft::photo {

/// The corners of a surface in reading order: top left, top right, bottom right, bottom left; px.
using Corners = std::array<Eigen::Vector2d, 4>;

/// Positive where b is clockwise of a, as the reader sees them.
inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// "top left" and so on.
const char* name_of_corner(std::size_t corner);

/// Checks that a surface can have its corners there: far enough from each other, no three on a
/// line, clockwise, convex. The message has the invalid ones, and what to do.
Result<void> check_corners(const Corners& corners_px);

/// px^2, as the surface's sides enclose it; negative where the corners run anticlockwise.
double signed_area_px2(const Corners& corners_px);

/// A rectangle as a pinhole camera sees it. With the homography H that takes the unit square to the
/// corners, M = K^-1 H = [m1 m2 m3]: the sides of the rectangle are along m1 and m2, so that
///     height / width = |m2| / |m1|,    m1 . m2 = 0
/// (Z. Zhang, L.-W. He, Whiteboard scanning and image enhancement, Digital Signal Processing 17(2),
/// 2007, section 3).
struct SheetView {
  Eigen::Matrix3d px_from_unit;  ///< H: (0,0), (1,0), (1,1), (0,1) go to the corners
  double height_over_width = 0.0;
  double skew_rad = 0.0;  ///< how far its corners are from right angles; 0 for a true rectangle
  double tilt_rad = 0.0;  ///< angle of its normal against the ray to its middle; 0 seen from above
};

/// For corners that check_corners() accepts, in px of the pinhole.
SheetView view_of_sheet(const Corners& corners_px, const Pinhole& camera);

/// The estimate of an unknown focal length from one view of a rectangle.
struct FocalGuess {
  double focal_px = 0.0;
  double ratio_error = 0.0;  ///< standard deviation of ln(height / width)
};

/// Sides must be at right angles (corners found to half a pixel). The focal length is likely near
/// that of `start` (ln f normal, sigma 0.2). The result is the mean under both. In a view from
/// above, the angles do not constrain the focal length, and the focal length does not affect the
/// ratio.
FocalGuess guess_focal_length(const Corners& corners_px, const Pinhole& start);

}  // namespace weft::photo
