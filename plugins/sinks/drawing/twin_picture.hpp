// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/template.hpp>

namespace weft::drawing {

/// The texture, pale, with its keypoints, which `pairs` have as template_px: a green dot for each,
/// an orange one where the pair is kept, and a line from there to its twin at image_px; BGR.
cv::Mat draw_twins(const Template& templ, const Correspondences& pairs);

}  // namespace weft::drawing
