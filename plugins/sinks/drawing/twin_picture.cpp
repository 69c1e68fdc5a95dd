// SPDX-License-Identifier: Apache-2.0
#include "twin_picture.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <weft/core/stop_check.hpp>

#include "picture.hpp"

namespace weft::drawing {
namespace {

constexpr double kLargestTexture_px = 1600.0, kSmallestTexture_px = 700.0, kPaleTexture = 0.65;
constexpr int kTwinShift = 4;  // positions are given to OpenCV in 1/16 px
const cv::Scalar kAlone(80, 160, 30), kHasTwin(0, 90, 255), kToTwin(120, 170, 255);  // BGR

/// The place of a texture point in the image that is `scale` times as large.
cv::Point twin_point(const Array<double>& places_px, std::int64_t i, double scale) {
  const auto coordinate = [&](int axis) {
    return static_cast<int>(
        std::lround((scale * (places_px(i, axis) + 0.5) - 0.5) * (1 << kTwinShift)));
  };
  return {coordinate(0), coordinate(1)};
}

}  // namespace

cv::Mat draw_twins(const Template& templ, const Correspondences& pairs) {
  const cv::Mat texture = texture_of(templ);
  const double largest = std::max(texture.cols, texture.rows);
  const double scale = std::clamp(largest, kSmallestTexture_px, kLargestTexture_px) / largest;
  cv::Mat picture;
  cv::resize(texture, picture, {}, scale, scale, scale < 1.0 ? cv::INTER_AREA : cv::INTER_LINEAR);
  picture.convertTo(picture, -1, 1.0 - kPaleTexture, kPaleTexture * 255.0);
  if (picture.channels() == 1) cv::cvtColor(picture, picture, cv::COLOR_GRAY2BGR);
  for (std::int64_t i = 0; i < pairs.count(); ++i) {
    worked_in_loop(i, 1000);
    if (pairs.kept(i) == 0) continue;
    cv::line(picture, twin_point(pairs.template_px, i, scale), twin_point(pairs.image_px, i, scale),
             kToTwin, 1, cv::LINE_AA, kTwinShift);
  }
  for (std::int64_t i = 0; i < pairs.count(); ++i) {
    constexpr int kRadius = 2;
    worked_in_loop(i, 1000);
    cv::circle(picture, twin_point(pairs.template_px, i, scale), kRadius << kTwinShift,
               pairs.kept(i) == 0 ? kAlone : kHasTwin, cv::FILLED, cv::LINE_AA, kTwinShift);
  }
  return picture;
}

}  // namespace weft::drawing
