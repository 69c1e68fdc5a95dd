// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace weft::onnx {

/// The descriptors at places in px of an image, interpolated bilinearly in a map f32 [1,D,h,w] that
/// covers the image: f32 [N,D]. The border of the map is repeated beyond it. With `align_corners`
/// the centres of the corner pixels of map and image coincide, else the edges do.
cv::Mat sample(const cv::Mat& map, const std::vector<cv::Point2d>& places_px, cv::Size image_px,
               bool align_corners);

/// Divides each row by its length; a row of zeros stays.
void normalise_rows(cv::Mat& descriptors);

/// A bit for each number, 1 where it is positive: u8 [N, D / 8 rounded up], the first number in the
/// highest bit of the first byte.
cv::Mat signs(const cv::Mat& descriptors);

}  // namespace weft::onnx
