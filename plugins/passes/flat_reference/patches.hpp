// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::flat_reference {

/// A word of the flat print.
struct Word {
  std::string text;
  cv::Rect box_px;
};

/// Reads a JSON list of {text, top, left, height, width} in pixels of the flat print; `text` and
/// other keys may be absent. Fails with the file and the entry where it is no such list, has no
/// entry, or a box has no area.
Result<std::vector<Word>> read_words(const std::string& file);

/// The boxes of the words. Fails with the first word whose centre lies outside of the texture.
Result<std::vector<cv::Rect>> boxes_of(const std::vector<Word>& words, cv::Size print_px);

/// Cells of a grid over the texture, those at its right and lower edge smaller.
std::vector<cv::Rect> grid_of(cv::Size print_px, cv::Size cell_px);

}  // namespace weft::flat_reference
