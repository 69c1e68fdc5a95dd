// SPDX-License-Identifier: Apache-2.0
#include "corner_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>
#include <vector>
#include <weft/core/base64.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/core/whole_file.hpp>

#include "corner_page_text.hpp"

namespace weft::photo {
namespace {

constexpr std::string_view kCornerPage(kCornerPageText, sizeof kCornerPageText - 1);
constexpr std::string_view kPlaceOfData = "WEFT_PHOTOGRAPH";

/// The bytes of a JPEG, at most 3200 px large.
std::string jpeg_of(const cv::Mat& pixels) {
  constexpr double kMostShown_px = 3200.0;
  constexpr int kQuality = 88;
  const double shrink = std::min(1.0, kMostShown_px / std::max(pixels.cols, pixels.rows));
  cv::Mat shown = pixels;
  ask_to_go_on();
  if (shrink < 1.0) cv::resize(pixels, shown, {}, shrink, shrink, cv::INTER_AREA);
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", shown, jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality});
  return {jpeg.begin(), jpeg.end()};
}

/// [[x, y], ...] in px of the photograph.
std::string json_of(const Photograph& photo, const std::optional<Corners>& corners_px) {
  if (!corners_px) return "null";
  std::vector<std::string> places;
  for (const Eigen::Vector2d& corner_px : *corners_px) {
    const Eigen::Vector2d at_px = photo.seen_at(corner_px);
    places.push_back(fmt::format("[{:.2f}, {:.2f}]", at_px.x(), at_px.y()));
  }
  return fmt::format("[{}]", fmt::join(places, ", "));
}

}  // namespace

Result<void> write_corner_page(const Photograph& photo, const std::optional<Corners>& corners_px,
                               const std::string& path) {
  const std::size_t place = kCornerPage.find(kPlaceOfData);
  std::string page(kCornerPage.substr(0, place));
  page += fmt::format(R"({{"width_px": {}, "height_px": {}, "corners_px": {}, )", photo.pixels.cols,
                      photo.pixels.rows, json_of(photo, corners_px));
  page += R"("picture": "data:image/jpeg;base64,)" + base64(jpeg_of(photo.pixels)) + "\"}";
  page += kCornerPage.substr(place + kPlaceOfData.size());
  return write_whole(page, path);
}

}  // namespace weft::photo
