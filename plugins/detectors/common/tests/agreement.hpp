// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "common/tests/scenes.hpp"

namespace weft::detectors {

/// How many keypoints of one answer have their like in another.
struct Agreement {
  double share;                  ///< share of the first result's keypoints
  double descriptor_difference;  ///< mean of |a - b| over the elements of pairs
};

/// A pair lies within 0.5 px, 10 % of scale and 10 degrees; no keypoint is in two pairs.
inline Agreement agreement(const Keypoints& first, const Keypoints& second) {
  constexpr double kPlacePx = 0.5, kScaleRatio = 1.1, kAngleRad = 10.0 * std::numbers::pi / 180.0;
  std::multimap<double, std::int64_t> free_by_x;
  for (std::int64_t j = 0; j < second.count(); ++j) free_by_x.emplace(second.xy_px(j, 0), j);
  std::int64_t paired = 0;
  double difference = 0.0;
  for (std::int64_t i = 0; i < first.count(); ++i) {
    auto best = free_by_x.end();
    double nearest = kPlacePx;
    const auto end = free_by_x.upper_bound(first.xy_px(i, 0) + kPlacePx);
    for (auto at = free_by_x.lower_bound(first.xy_px(i, 0) - kPlacePx); at != end; ++at) {
      const std::int64_t j = at->second;
      const double distance = std::hypot(first.xy_px(i, 0) - second.xy_px(j, 0),
                                         first.xy_px(i, 1) - second.xy_px(j, 1));
      const double ratio = first.scale_px(i) / second.scale_px(j);
      const double turn =
          std::remainder(first.angle_rad(i) - second.angle_rad(j), 2.0 * std::numbers::pi);
      if (distance > nearest || std::abs(turn) > kAngleRad || ratio > kScaleRatio ||
          1.0 / ratio > kScaleRatio) {
        continue;
      }
      nearest = distance;
      best = at;
    }
    if (best == free_by_x.end()) continue;
    ++paired;
    for (int d = 0; d < 128; ++d) {
      difference += std::abs(first.descriptors(i, d) - second.descriptors(best->second, d));
    }
    free_by_x.erase(best);
  }
  return {static_cast<double>(paired) / static_cast<double>(first.count()),
          difference / (128.0 * static_cast<double>(paired))};
}

/// An image of a file, at most `width_px` wide.
inline Image image_of_file(const std::string& file, int width_px) {
  cv::Mat picture = cv::imread(file, cv::IMREAD_COLOR);
  if (picture.empty()) throw std::runtime_error("cannot read " + file);
  if (picture.cols > width_px) {
    const double scale = static_cast<double>(width_px) / picture.cols;
    cv::resize(picture, picture, {}, scale, scale, cv::INTER_AREA);
  }
  Image image;
  image.pixels = Array<std::uint8_t>({picture.rows, picture.cols, 3}, 0);
  picture.copyTo(cv::Mat(picture.rows, picture.cols, CV_8UC3, image.pixels.data()));
  return image;
}

}  // namespace weft::detectors
