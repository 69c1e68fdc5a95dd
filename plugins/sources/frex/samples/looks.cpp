// SPDX-License-Identifier: Apache-2.0
#include "samples/looks.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "degradation.hpp"

namespace weft::frex {
namespace {

constexpr int kSensors = 6;

/// A spot of light, in grey levels.
struct Highlight {
  double x_px = 0.0, y_px = 0.0, radius_px = 1.0;
  double grey = 0.0;

  float at(int x, int y) const {
    if (grey <= 0.0) return 0.0F;
    const double distance = std::hypot(x - x_px, y - y_px) / radius_px;
    return static_cast<float>(grey * std::exp(-0.5 * distance * distance));
  }
};

Highlight random_highlight(const Picture& picture, double light, Rng& rng) {
  constexpr double kShare = 0.3, kMost_grey = 90.0;
  Highlight spot;
  spot.x_px = rng.uniform(0.0, picture.width);
  spot.y_px = rng.uniform(0.0, picture.height);
  spot.radius_px = picture.height * rng.uniform(0.04, 0.2);
  const double grey = light * rng.uniform(0.0, kMost_grey);
  spot.grey = rng.uniform() < kShare ? grey : 0.0;
  return spot;
}

/// 255 (grey / 255)^gamma for grey levels with four parts each.
std::vector<float> gamma_table(double gamma) {
  constexpr int kParts = 4, kGreys = 256;
  std::vector<float> table(to_index(kParts * kGreys));
  for (std::size_t k = 0; k < table.size(); ++k) {
    const double share = static_cast<double>(k) / (kParts * 255.0);
    table[k] = static_cast<float>(255.0 * std::pow(share, gamma));
  }
  return table;
}

}  // namespace

Looks::Looks(const LookRanges& ranges) : ranges_(ranges) {
  for (int k = 0; k < kSensors; ++k) {
    sensors_.emplace_back(0.0, ranges.noise_grey * k / (kSensors - 1));
  }
}

scene::Light Looks::lamp(Rng& rng) const {
  const double azimuth_rad = rng.uniform(0.0, 2.0 * M_PI);
  const double off_axis_rad = ranges_.light * rng.uniform(0.0, 1.0);
  const double ambient = 1.0 - std::min(ranges_.light * rng.uniform(0.1, 0.75), 1.0);
  return {{std::sin(off_axis_rad) * std::cos(azimuth_rad),
           std::sin(off_axis_rad) * std::sin(azimuth_rad), -std::cos(off_axis_rad)},
          ambient};
}

void Looks::relight(const Array<float>& coverage, Rng& rng, Picture& picture) const {
  const double light = ranges_.light;
  const double gain = std::exp(light * rng.uniform(-0.5, 0.35));
  const std::vector<float> table = gamma_table(std::exp(light * rng.uniform(-0.3, 0.3)));
  const double to_right = light * rng.uniform(-0.3, 0.3) / picture.width;
  const double to_bottom = light * rng.uniform(-0.3, 0.3) / picture.height;
  scene::Colour tint = scene::Colour::Zero();
  for (int k = 0; k < 3; ++k) {
    tint[k] = static_cast<float>(gain * (1.0 + light * rng.uniform(-0.12, 0.12)));
  }
  const Highlight spot = random_highlight(picture, light, rng);
  const auto last = static_cast<float>(table.size() - 1);
  for (int y = 0; y < picture.height; ++y) {
    ask_to_go_on();
    for (int x = 0; x < picture.width; ++x) {
      scene::Colour& colour = picture.pixels[to_index(y) * to_index(picture.width) + to_index(x)];
      const double slope =
          1.0 + to_right * (x - 0.5 * picture.width) + to_bottom * (y - 0.5 * picture.height);
      colour = (static_cast<float>(slope) * tint * colour + coverage(y, x) * spot.at(x, y));
      for (int k = 0; k < 3; ++k) {
        colour[k] = table[to_index(std::clamp(4.0F * colour[k] + 0.5F, 0.0F, last))];
      }
    }
  }
}

Array<std::uint8_t> Looks::expose(Picture& picture, Rng& rng) const {
  constexpr double kBlurred = 0.5, kMoving = 0.33, kGrey = 0.4;
  const double share = rng.uniform();
  const double blur_px = rng.uniform() < kBlurred ? share * share * ranges_.blur_px : 0.0;
  const double length_px = ranges_.motion_blur_px * rng.uniform();
  const double direction_rad = rng.uniform(0.0, M_PI);
  if (rng.uniform() < kMoving && length_px > 0.5) {
    blur_along(length_px * Eigen::Vector2d(std::cos(direction_rad), std::sin(direction_rad)),
               picture);
  }
  if (blur_px > 0.2) {
    const cv::Mat image(picture.height, picture.width, CV_32FC4, picture.pixels.data());
    const int reach = static_cast<int>(std::ceil(2.5 * blur_px));
    cv::GaussianBlur(image, image, {2 * reach + 1, 2 * reach + 1}, blur_px, blur_px,
                     cv::BORDER_REPLICATE);
  }
  if (rng.uniform() < kGrey) picture = scene::without_colour(std::move(picture));
  return sensors_[rng.below(kSensors)].expose(picture, false, rng);
}

}  // namespace weft::frex
