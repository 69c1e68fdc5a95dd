// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

namespace weft::outline {

/// Corners of a closed polygon in px, pixel centres at integers, the last joined to the first.
using Polygon = std::vector<Eigen::Vector2d>;

/// The outline of an object and of its holes.
struct Outline {
  Polygon outer;
  std::vector<Polygon> holes;

  double area_px2() const;
};

/// Follows the border of the largest region of a mask [H,W] of 0 and 1, where its blurred copy
/// (sigma 1 px) passes one half: to about 0.1 px on smooth outlines. Simplified by Douglas and
/// Peucker within 0.2 px. The outer polygon has fewer than 3 corners only if the mask is empty.
Outline trace_outline(const cv::Mat& mask);

/// The same outline with corners about `spacing_px` apart: equally spaced along the arc between its
/// sharp corners, which are kept.
Outline resampled(const Outline& outline, double spacing_px);

/// Area within a polygon, not negative.
double area_px2(const Polygon& polygon);

}  // namespace weft::outline
