// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/template.hpp>

namespace weft::drawing {

/// The texture, pale, with the keypoints that `pairs` have as template_px; BGR. Each has a green
/// dot. A kept pair has an orange dot instead, and a line to its twin at image_px.
cv::Mat draw_twins(const Template& templ, const Correspondences& pairs);

}  // namespace weft::drawing
