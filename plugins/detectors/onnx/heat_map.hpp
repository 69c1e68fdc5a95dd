// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace weft::onnx {

/// A maximum of a map of scores.
struct Peak {
  double x_px = 0.0, y_px = 0.0;  ///< px of the map
  float score = 0.0F;
};

/// The maxima of a map f32 [h,w], row by row: pixels of at least `threshold` that are the largest
/// within `radius_px` along x and y. None is nearer than `border_px` to the border. The first of
/// equal scores counts. A pixel whose neighbours all have its score is no maximum.
std::vector<Peak> find_peaks(const cv::Mat& scores, double threshold, int radius_px, int border_px);

/// The offset of the maximum of the quadratic function through a pixel and its neighbours, at most
/// one pixel along x and y. It is 0 along an axis without two neighbours or without a maximum.
cv::Point2d refined_offset(const cv::Mat& scores, int x, int y);

}  // namespace weft::onnx
