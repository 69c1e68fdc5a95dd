// SPDX-License-Identifier: Apache-2.0
#include "rectified.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::photo {
namespace {

/// Number of samples along each side of a texel so that their distances are at most the
/// photograph's pixels, where the surface appears largest.
int samples_a_texel(const Eigen::Matrix3d& ideal_from_unit, const cv::Size& size_px) {
  // OpenCV's remapping counts columns in 16 bits.
  const double most = std::clamp(std::floor(32766.0 / size_px.width), 1.0, 8.0);
  double longest = 0.0;  // px of the photograph in a texel
  for (const double u : {0.0, 1.0}) {
    for (const double v : {0.0, 1.0}) {
      const Eigen::Vector2d corner = ideal_px(ideal_from_unit, u, v);
      const double inwards_u = (u > 0.5 ? -1.0 : 1.0) / size_px.width;
      const double inwards_v = (v > 0.5 ? -1.0 : 1.0) / size_px.height;
      longest = std::max({longest, (ideal_px(ideal_from_unit, u + inwards_u, v) - corner).norm(),
                          (ideal_px(ideal_from_unit, u, v + inwards_v) - corner).norm()});
    }
  }
  constexpr double kAlmostOne = 0.2;  // a texel that is so little larger than a pixel is one
  return static_cast<int>(std::clamp(std::ceil(longest - kAlmostOne), 1.0, most));
}

}  // namespace

cv::Mat rectified(const Photograph& photo, const Eigen::Matrix3d& ideal_from_unit,
                  const cv::Size& size_px) {
  constexpr int kStripe = 16;  // rows at a time: their map may have 64 times as many samples
  const int fine = samples_a_texel(ideal_from_unit, size_px);
  const double step_u = 1.0 / (fine * size_px.width), step_v = 1.0 / (fine * size_px.height);
  cv::Mat texture(size_px, photo.pixels.type());
  for (int top = 0; top < size_px.height; top += kStripe) {
    const int rows = std::min(kStripe, size_px.height - top);
    cv::Mat map(fine * rows, fine * size_px.width, CV_32FC2), drawn;
    for (int y = 0; y < map.rows; ++y) {
      worked(10L * map.cols);
      const double v = (fine * top + y + 0.5) * step_v;
      auto* row = map.ptr<cv::Vec2f>(y);
      for (int x = 0; x < map.cols; ++x) {
        const Eigen::Vector2d at = photo.seen_at(ideal_px(ideal_from_unit, (x + 0.5) * step_u, v));
        row[x] = cv::Vec2f(static_cast<float>(at.x()), static_cast<float>(at.y()));
      }
    }
    cv::remap(photo.pixels, drawn, map, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
    cv::Mat stripe = texture.rowRange(top, top + rows);
    cv::resize(drawn, stripe, stripe.size(), 0.0, 0.0, cv::INTER_AREA);
  }
  return texture;
}

}  // namespace weft::photo
