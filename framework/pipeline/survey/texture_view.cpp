// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/texture_view.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <weft/core/rng.hpp>
#include <weft/geometry/object_box.hpp>

namespace weft {
namespace {

constexpr double kBackground_grey = 128.0, kNoise_grey = 2.0;
constexpr double kMargin_px = 12.0;

/// ITU-R BT.601 for BGR.
double grey_of(const std::uint8_t* pixel, std::int64_t channels) {
  if (channels < 3) return *pixel;
  return 0.114 * pixel[0] + 0.587 * pixel[1] + 0.299 * pixel[2];
}

/// Bilinear; the background beside the object.
double grey_at(const Template& templ, const Eigen::Vector2d& at_px) {
  const std::int64_t width = templ.texture.dim(1), height = templ.texture.dim(0);
  const std::int64_t u = std::llround(at_px.x()), v = std::llround(at_px.y());
  if (u < 0 || v < 0 || u >= width || v >= height || templ.mask(v, u) == 0) {
    return kBackground_grey;
  }
  const double x = std::clamp(at_px.x(), 0.0, static_cast<double>(width - 1));
  const double y = std::clamp(at_px.y(), 0.0, static_cast<double>(height - 1));
  const auto left = static_cast<std::int64_t>(x), top = static_cast<std::int64_t>(y);
  const std::int64_t right = std::min(left + 1, width - 1), below = std::min(top + 1, height - 1);
  const double s = x - static_cast<double>(left), t = y - static_cast<double>(top);
  const std::int64_t channels = templ.texture.dim(2);
  const auto grey = [&](std::int64_t row, std::int64_t column) {
    return grey_of(templ.texture.row(row) + channels * column, channels);
  };
  return (1.0 - t) * ((1.0 - s) * grey(top, left) + s * grey(top, right)) +
         t * ((1.0 - s) * grey(below, left) + s * grey(below, right));
}

}  // namespace

TextureView view_of_texture(const Template& templ, double longest_px, std::uint64_t seed) {
  constexpr double kTurn_rad = 15.0 * M_PI / 180.0, kTilt_rad = 30.0 * M_PI / 180.0;
  const TextureBox object = object_box(templ);
  const double scale = std::min(1.0, longest_px / std::max(object.width_px(), object.height_px()));
  TextureView view;
  view.turn = scale * Eigen::Rotation2Dd(kTurn_rad).toRotationMatrix() *
              Eigen::Vector2d(1.0, std::cos(kTilt_rad)).asDiagonal();
  Eigen::AlignedBox2d box;
  for (const double u : {object.u0, object.u1}) {
    for (const double v : {object.v0, object.v1}) box.extend(view.turn * Eigen::Vector2d(u, v));
  }
  view.shift = Eigen::Vector2d::Constant(kMargin_px) - box.min();
  const auto width = static_cast<std::int64_t>(std::ceil(box.sizes().x() + 2.0 * kMargin_px));
  const auto height = static_cast<std::int64_t>(std::ceil(box.sizes().y() + 2.0 * kMargin_px));
  view.image.stem = "view";
  view.image.pixels = Array<std::uint8_t>({height, width});
  const Eigen::Matrix2d back = view.turn.inverse();
  const int samples = static_cast<int>(std::ceil(1.0 / (scale * std::cos(kTilt_rad))));
  Rng rng(seed);
  for (std::int64_t y = 0; y < height; ++y) {
    for (std::int64_t x = 0; x < width; ++x) {
      const Eigen::Vector2d corner(static_cast<double>(x) - 0.5, static_cast<double>(y) - 0.5);
      double sum = 0.0;
      for (int j = 0; j < samples; ++j) {
        for (int i = 0; i < samples; ++i) {
          const Eigen::Vector2d inside((i + 0.5) / samples, (j + 0.5) / samples);
          sum += grey_at(templ, back * (corner + inside - view.shift));
        }
      }
      const double level = sum / (samples * samples) + kNoise_grey * rng.normal();
      view.image.pixels(y, x) = static_cast<std::uint8_t>(std::clamp(level + 0.5, 0.0, 255.0));
    }
  }
  return view;
}

}  // namespace weft
