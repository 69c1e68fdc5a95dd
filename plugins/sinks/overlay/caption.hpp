// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <weft/sdk/sink.hpp>

namespace weft::overlay {

/// The description of a frame, in words.
struct Caption {
  std::string state;   ///< "no result" where there is no shape
  std::string reason;  ///< evidence for the state, as far as the records of the frame have it
  std::string place;   ///< stem and time
  std::optional<double> confidence;  ///< [] 0 to 1; none without a shape
};

Caption caption_of(const SinkInput& in);

/// [px] of the strip below an image of this size; even.
int caption_height_px(cv::Size image);

/// Fills the strip: state and reason at the left, confidence with its colours and the place at the
/// right.
void draw_caption(cv::Mat strip, const Caption& caption);

}  // namespace weft::overlay
