// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <weft/sdk/sink.hpp>

namespace weft::drawing {

/// The image, pale, with the shape's mesh, and of each kept match a line from where it is seen to
/// where the shape has it; BGR. All inputs must be there.
cv::Mat draw_matches(const SinkInput& in);

}  // namespace weft::drawing
