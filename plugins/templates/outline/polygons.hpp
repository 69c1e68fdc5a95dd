// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "common/polygon.hpp"

namespace weft::outline {

/// Follows the border of the largest region of a mask [H,W] of 0 and 1, where its blurred copy
/// (sigma 1 px) passes one half. Pixel centres are at integers. The accuracy is about 0.1 px on
/// smooth outlines. Simplified by Douglas and Peucker within 0.2 px. The outer polygon has fewer
/// than 3 corners only if the mask is empty.
Outline trace_outline(const cv::Mat& mask);

/// The same outline with corners at distances of about `spacing_px`: equally spaced along the arc
/// between its sharp corners, which are kept.
Outline resampled(const Outline& outline, double spacing_px);

}  // namespace weft::outline
