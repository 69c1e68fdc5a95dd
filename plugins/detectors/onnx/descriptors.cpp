// SPDX-License-Identifier: Apache-2.0
#include "descriptors.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::onnx {
namespace {

/// Two neighbouring pixels of a map along an axis, and the share of the second.
struct Pair {
  int first = 0, second = 0;
  float share = 0.0F;
};

Pair pair_at(double place_px, int image_px, int map_px, bool align_corners) {
  const double scale =
      align_corners ? (map_px - 1.0) / (image_px - 1.0) : static_cast<double>(map_px) / image_px;
  const double place = align_corners ? scale * place_px : scale * (place_px + 0.5) - 0.5;
  const double inside = std::clamp(place, 0.0, map_px - 1.0);
  const int first = static_cast<int>(inside);
  return {first, std::min(first + 1, map_px - 1), static_cast<float>(inside - first)};
}

}  // namespace

cv::Mat sample(const cv::Mat& map, const std::vector<cv::Point2d>& places_px, cv::Size image_px,
               bool align_corners) {
  const int channels = map.size[1], height = map.size[2], width = map.size[3];
  const auto plane = to_index(height) * to_index(width);
  cv::Mat descriptors(static_cast<int>(places_px.size()), channels, CV_32F);
  for (int n = 0; n < descriptors.rows; ++n) {
    worked(channels);
    const cv::Point2d& place = places_px[to_index(n)];
    const Pair x = pair_at(place.x, image_px.width, width, align_corners);
    const Pair y = pair_at(place.y, image_px.height, height, align_corners);
    const float* values = map.ptr<float>();
    const float *above = values + y.first * width, *below = values + y.second * width;
    float* to = descriptors.ptr<float>(n);
    for (int c = 0; c < channels; ++c, above += plane, below += plane) {
      const float upper = (1.0F - x.share) * above[x.first] + x.share * above[x.second];
      const float lower = (1.0F - x.share) * below[x.first] + x.share * below[x.second];
      to[c] = (1.0F - y.share) * upper + y.share * lower;
    }
  }
  return descriptors;
}

void normalise_rows(cv::Mat& descriptors) {
  for (int n = 0; n < descriptors.rows; ++n) {
    cv::Mat row = descriptors.row(n);
    const double length = cv::norm(row);
    if (length > 0.0) row *= 1.0 / length;
  }
}

cv::Mat signs(const cv::Mat& descriptors) {
  cv::Mat bits = cv::Mat::zeros(descriptors.rows, (descriptors.cols + 7) / 8, CV_8U);
  for (int n = 0; n < descriptors.rows; ++n) {
    const float* values = descriptors.ptr<float>(n);
    auto* bytes = bits.ptr<std::uint8_t>(n);
    for (int c = 0; c < descriptors.cols; ++c) {
      if (values[c] > 0.0F) bytes[c / 8] |= static_cast<std::uint8_t>(0x80U >> (c % 8));
    }
  }
  return bits;
}

}  // namespace weft::onnx
