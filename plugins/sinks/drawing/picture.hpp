// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <weft/data/template.hpp>

namespace weft::drawing {

/// The texture as OpenCV sees it, grey or BGR; it is not copied.
cv::Mat texture_of(const Template& templ);

/// The mesh over the texture, which is pale outside the mask; BGR. Where the object is not flat, it
/// is shown beside this from the front, from the left and above.
cv::Mat draw_mesh(const Template& templ);

}  // namespace weft::drawing
