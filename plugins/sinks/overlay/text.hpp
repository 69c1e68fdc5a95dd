// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace weft::overlay {

/// The part of a text that is placed at the given point.
enum class Anchor { left, centre, right };

struct TextStyle {
  double capital_px;  ///< [] px, height of a capital letter
  cv::Scalar colour;  ///< BGR
  bool is_bold = false;
  double most_px = 1e9;  ///< [] px of width; a longer text is written smaller
};

/// Writes one line of ASCII text, smooth at every size, with `base` on its base line.
void draw_text(cv::Mat& canvas, const std::string& text, cv::Point2d base, Anchor anchor,
               const TextStyle& style);

/// [px] that draw_text() takes, at most `most_px`.
double text_width_px(const std::string& text, const TextStyle& style);

}  // namespace weft::overlay
