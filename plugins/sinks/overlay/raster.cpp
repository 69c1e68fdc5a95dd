// SPDX-License-Identifier: Apache-2.0
#include "raster.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <weft/core/index.hpp>

#include "span.hpp"

namespace weft::overlay {
namespace {

double cross(const cv::Point2d& a, const cv::Point2d& b) { return a.x * b.y - a.y * b.x; }

std::array<float, 3> floats(const cv::Scalar& colour) {
  return {static_cast<float>(colour[0]), static_cast<float>(colour[1]),
          static_cast<float>(colour[2])};
}

}  // namespace

Paint::Paint(const cv::Mat& texture, const cv::Scalar& blank, double line_px)
    : blank_(blank), line_px_(line_px) {
  cv::Mat padded;
  cv::copyMakeBorder(texture, padded, 0, 1, 0, 1, cv::BORDER_REPLICATE);
  cv::cvtColor(padded, texels_, cv::COLOR_BGR2BGRA);
}

void Raster::clear(cv::Size size) {
  if (size != size_) {
    // One row more, into which the last row's spans may reach.
    nearness_ = cv::Mat1f::zeros(size.height + 1, std::max(size.width, kPixelsBehind));
    colour_ = cv::Mat1i::zeros(nearness_.size());
    size_ = size;
  } else {
    nearness_(window_).setTo(0.0F);
  }
  window_ = {};
}

cv::Vec3b Raster::colour(cv::Point at) const {
  const std::int32_t bgr = colour_(at);
  return {static_cast<std::uint8_t>(bgr & 0xFF), static_cast<std::uint8_t>(bgr >> 8 & 0xFF),
          static_cast<std::uint8_t>(bgr >> 16 & 0xFF)};
}

void Raster::draw(const std::array<Corner, 3>& corners, const std::array<bool, 3>& sides,
                  const Paint& paint) {
  const double area =
      cross(corners[1].at_px - corners[0].at_px, corners[2].at_px - corners[0].at_px);
  const auto [top, bottom] =
      std::minmax({corners[0].at_px.y, corners[1].at_px.y, corners[2].at_px.y});
  if (!(std::abs(area) > 1e-9)) return;
  const int rows = size_.height, columns = size_.width;
  const int y0 = static_cast<int>(std::ceil(std::clamp<double>(top, 0.0, rows)));
  const int y1 = static_cast<int>(std::floor(std::clamp<double>(bottom, -1.0, rows - 1)));

  std::array<cv::Point2d, 3> gradient;  // 1/px, weights of the corners
  std::array<double, 3> height_px{};    // heights of the corners above their sides
  for (std::size_t k = 0; k < 3; ++k) {
    const cv::Point2d side = corners[(k + 2) % 3].at_px - corners[(k + 1) % 3].at_px;
    gradient[k] = cv::Point2d(-side.y, side.x) / area;
    height_px[k] = 1.0 / std::hypot(gradient[k].x, gradient[k].y);
  }
  Span span;
  span.texels = reinterpret_cast<const std::int32_t*>(paint.texels_.ptr());
  span.texels_per_row = paint.texels_.cols;
  span.last_u = static_cast<float>(paint.texels_.cols - 2);
  span.last_v = static_cast<float>(paint.texels_.rows - 2);
  span.reach_px = static_cast<float>(0.5 * paint.line_px_ + 0.5);
  span.blank = floats(paint.blank_);
  span.line = floats(paint.line_colour);

  for (int y = y0; y <= y1; ++y) {
    // Pixels with no negative weight. The margin keeps those on a side, which two triangles share.
    constexpr double kMargin_px = 1e-9;
    double left = 0.0, right = columns - 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const cv::Point2d& on_side = corners[(k + 1) % 3].at_px;
      const double above = gradient[k].y * (y - on_side.y), slope = gradient[k].x;
      if (slope == 0.0) {
        if (above < 0.0) right = -1.0;
      } else if (slope > 0.0) {
        left = std::max(left, on_side.x - above / slope - kMargin_px);
      } else {
        right = std::min(right, on_side.x - above / slope + kMargin_px);
      }
    }
    if (!(left <= right)) continue;
    const int x0 = static_cast<int>(std::ceil(left)), x1 = static_cast<int>(std::floor(right));
    if (x0 > x1) continue;

    std::array<double, 3> weight{};
    for (std::size_t k = 0; k < 3; ++k) {
      weight[k] = gradient[k].dot(cv::Point2d(x0, y) - corners[(k + 1) % 3].at_px);
    }
    const auto ramp = [&](auto&& value_of) {
      double first = 0.0, step = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double value = corners[k].nearness * value_of(corners[k]);
        first += weight[k] * value;
        step += gradient[k].x * value;
      }
      return Ramp{static_cast<float>(first), static_cast<float>(step)};
    };
    span.count = to_index(x1 - x0 + 1);
    span.nearness = ramp([](const Corner&) { return 1.0; });
    span.u = ramp([](const Corner& c) { return c.uv_px.x; });
    span.v = ramp([](const Corner& c) { return c.uv_px.y; });
    span.light = ramp([](const Corner& c) { return c.light; });
    span.pallor = ramp([](const Corner& c) { return c.pallor; });
    for (std::size_t k = 0; k < 3; ++k) {
      span.distance_px[k] = sides[k] ? Ramp{static_cast<float>(weight[k] * height_px[k]),
                                            static_cast<float>(gradient[k].x * height_px[k])}
                                     : Ramp{span.reach_px, 0.0F};
    }
    fill(span, nearness_[y] + x0, colour_[y] + x0);
    window_ |= cv::Rect(x0, y, x1 - x0 + 1, 1);
  }
}

template <int finer>
void Raster::lay_over(cv::Mat& canvas) const {
  constexpr int kSamples = finer * finer;
  for (int y = window_.y / finer; y * finer < window_.br().y; ++y) {
    auto* const pixels = canvas.ptr<cv::Vec3b>(y);
    for (int x = window_.x / finer; x * finer < window_.br().x; ++x) {
      int blue = kSamples / 2, green = blue, red = blue, covered = 0;
      for (int k = 0; k < kSamples; ++k) {
        const int row = finer * y + k / finer, column = finer * x + k % finer;
        if (nearness_[row][column] <= 0.0F) continue;
        const std::int32_t bgr = colour_[row][column];
        blue += bgr & 0xFF;
        green += bgr >> 8 & 0xFF;
        red += bgr >> 16;
        ++covered;
      }
      if (covered == 0) continue;
      const auto mean = [&](int sum, int behind) {
        return static_cast<std::uint8_t>((sum + (kSamples - covered) * behind) / kSamples);
      };
      cv::Vec3b& pixel = pixels[x];
      pixel = {mean(blue, pixel[0]), mean(green, pixel[1]), mean(red, pixel[2])};
    }
  }
}

template void Raster::lay_over<1>(cv::Mat&) const;
template void Raster::lay_over<2>(cv::Mat&) const;

}  // namespace weft::overlay
