// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/template.hpp>

namespace weft::drawing {

/// The texture, pale, with the keypoints that `pairs` have as template_px; BGR. Each has a green
/// dot, or an orange one where the pair is kept, and a line to its twin at image_px.
cv::Mat draw_twins(const Template& templ, const Correspondences& pairs);

}  // namespace weft::drawing
