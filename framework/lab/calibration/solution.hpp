// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/core/result.hpp>

#include "lab/calibration/view.hpp"

namespace weft::calibration {

/// Residuals of a view: seen minus projected.
struct ViewError {
  double rms_px = 0.0;
  Eigen::MatrixX2d residual_px;  ///< [C,2] px
};

/// A camera, and how far it can be trusted.
struct Solution {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< px
  std::vector<double> distortion;  ///< none, or k1 k2 p1 p2, k3, k4 k5 k6: the requested number
  /// [4 + D] standard deviations of fx, fy, cx, cy and the distortion, if the errors of corners are
  /// independent and of one size.
  Eigen::VectorXd deviation;
  double rms_px = 0.0;                    ///< RMS of the distances of all corners
  std::vector<ViewError> errors;          ///< errors of the views, in their order
  std::vector<Eigen::Vector2d> tilt_rad;  ///< the same, as in Placement
  /// Largest by smallest eigenvalue of the camera's normal matrix, poses eliminated, with a
  /// diagonal of ones.
  double condition = 0.0;
};

/// Fits a pinhole with `coefficients` of distortion (0, 4, 5 or 8) to views of a flat board by
/// least squares of distances in the image (Zhang 2000; cv::calibrateCamera). Errc::no_result where
/// the views do not determine it.
Result<Solution> solve(const std::vector<View>& views, const ImageSize& size, int coefficients);

}  // namespace weft::calibration
