// SPDX-License-Identifier: Apache-2.0
#include "patches.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <weft/core/text_file.hpp>

namespace weft::flat_reference {
namespace {

using nlohmann::json;

constexpr std::uint64_t kMostBytes = 64'000'000;
constexpr double kLargestPlacePx = 1e6;
constexpr const char* kForm =
    "give a list of {\"text\": ..., \"top\": ..., \"left\": ..., \"height\": ..., \"width\": ...} "
    "in "
    "pixels of the flat print";

/// The number of a key, or NaN where it has none that can be a place.
double place_of(const json& entry, const char* key) {
  const auto found = entry.find(key);
  if (found == entry.end() || !found->is_number()) return std::nan("");
  const double place_px = found->get<double>();
  return std::abs(place_px) <= kLargestPlacePx ? place_px : std::nan("");
}

/// The word, or why the entry is none.
Result<Word> word_of(const json& entry) {
  if (!entry.is_object()) return Error{Errc::invalid_data, "is no object", {}};
  double values[4];
  constexpr const char* kKeys[] = {"left", "top", "width", "height"};
  for (int i = 0; i < 4; ++i) {
    values[i] = place_of(entry, kKeys[i]);
    if (std::isfinite(values[i])) continue;
    return Error{Errc::invalid_data,
                 std::string("has no number '") + kKeys[i] + "' of at most 1,000,000 px",
                 {}};
  }
  Word word;
  const auto text = entry.find("text");
  if (text != entry.end() && text->is_string()) word.text = text->get<std::string>();
  word.box_px = {cv::saturate_cast<int>(values[0]), cv::saturate_cast<int>(values[1]),
                 cv::saturate_cast<int>(values[2]), cv::saturate_cast<int>(values[3])};
  if (word.box_px.width >= 1 && word.box_px.height >= 1) return word;
  return Error{Errc::invalid_data, "has a box without area", {}};
}

}  // namespace

Result<std::vector<Word>> read_words(const std::string& file) {
  const auto text = read_text_file(file, kMostBytes);
  if (!text) return Error{text.error().code, "cannot be read: " + text.error().message, file};
  const json list = json::parse(*text, nullptr, false);
  if (list.is_discarded()) {
    return Error{Errc::syntax, std::string("is no JSON; ") + kForm, file};
  }
  if (!list.is_array()) {
    return Error{Errc::invalid_data, std::string("is no list of words; ") + kForm, file};
  }
  if (list.empty()) {
    return Error{Errc::invalid_data,
                 "has no words; without a file of words, patches of a grid are searched", file};
  }
  std::vector<Word> words;
  for (const json& entry : list) {
    auto word = word_of(entry);
    if (!word) {
      return Error{
          Errc::invalid_data,
          "entry " + std::to_string(words.size()) + " " + word.error().message + "; " + kForm,
          file};
    }
    words.push_back(*std::move(word));
  }
  return words;
}

Result<std::vector<cv::Rect>> boxes_of(const std::vector<Word>& words, cv::Size print_px) {
  std::vector<cv::Rect> boxes;
  for (const Word& word : words) {
    const cv::Rect& box = word.box_px;
    const cv::Point centre(box.x + box.width / 2, box.y + box.height / 2);
    boxes.push_back(box);
    if (cv::Rect({}, print_px).contains(centre)) continue;
    return Error{Errc::invalid_data,
                 "word " + std::to_string(boxes.size() - 1) + " ('" + word.text + "') at left " +
                     std::to_string(box.x) + ", top " + std::to_string(box.y) +
                     " px lies outside of the texture of " + std::to_string(print_px.width) +
                     " x " + std::to_string(print_px.height) +
                     " px; give the words of this texture, at its resolution",
                 {}};
  }
  return boxes;
}

std::vector<cv::Rect> grid_of(cv::Size print_px, cv::Size cell_px) {
  std::vector<cv::Rect> cells;
  for (int y = 0; y < print_px.height; y += cell_px.height) {
    for (int x = 0; x < print_px.width; x += cell_px.width) {
      cells.emplace_back(x, y, std::min(cell_px.width, print_px.width - x),
                         std::min(cell_px.height, print_px.height - y));
    }
  }
  return cells;
}

}  // namespace weft::flat_reference
