// SPDX-License-Identifier: Apache-2.0
#include "common/scene/mip_texture.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::scene {
namespace {

Picture halved(const Picture& full) {
  Picture half{std::max(1, full.width / 2), std::max(1, full.height / 2)};
  half.pixels.reserve(to_index(half.width) * to_index(half.height));
  for (int y = 0; y < half.height; ++y) {
    ask_to_go_on();
    const int below = std::min(2 * y + 1, full.height - 1);
    for (int x = 0; x < half.width; ++x) {
      const int right = std::min(2 * x + 1, full.width - 1);
      half.pixels.emplace_back(0.25F * (full.at(2 * x, 2 * y) + full.at(right, 2 * y) +
                                        full.at(2 * x, below) + full.at(right, below)));
    }
  }
  return half;
}

Colour colour_of(const cv::Mat& image, int x, int y) {
  if (image.channels() == 1) return Colour::Constant(image.at<std::uint8_t>(y, x));
  const auto& bgr = image.at<cv::Vec3b>(y, x);
  return {static_cast<float>(bgr[0]), static_cast<float>(bgr[1]), static_cast<float>(bgr[2]), 0.0F};
}

Picture picture_of(const cv::Mat& image) {
  Picture picture{image.cols, image.rows};
  picture.pixels.reserve(image.total());
  for (int y = 0; y < image.rows; ++y) {
    ask_to_go_on();
    for (int x = 0; x < image.cols; ++x) picture.pixels.push_back(colour_of(image, x, y));
  }
  return picture;
}

}  // namespace

MipTexture::MipTexture(const cv::Mat& picture)
    : MipTexture(picture_of(picture), picture.channels() == 1) {}

MipTexture::MipTexture(Picture picture, bool is_grey) : is_grey_(is_grey) {
  levels_.push_back(std::move(picture));
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    levels_.push_back(halved(levels_.back()));
  }
}

Colour MipTexture::bilinear(const Picture& level, float scale, float u, float v) const {
  // Pixel centres are integers: the centre of a block of 2 x 2 is half a pixel from its first.
  const float a = std::clamp((u + 0.5F) * scale - 0.5F, 0.0F, static_cast<float>(level.width - 1));
  const float b = std::clamp((v + 0.5F) * scale - 0.5F, 0.0F, static_cast<float>(level.height - 1));
  const int i = static_cast<int>(a), j = static_cast<int>(b);
  const float s = a - static_cast<float>(i), t = b - static_cast<float>(j);
  const int right = std::min(i + 1, level.width - 1), below = std::min(j + 1, level.height - 1);
  return (1.0F - t) * ((1.0F - s) * level.at(i, j) + s * level.at(right, j)) +
         t * ((1.0F - s) * level.at(i, below) + s * level.at(right, below));
}

Colour MipTexture::sample(float u, float v, float texels) const {
  const auto coarsest = static_cast<float>(levels_.size() - 1);
  const float depth = texels > 1.0F ? std::min(std::log2(texels), coarsest) : 0.0F;
  const auto fine = to_index(depth);
  const float share = depth - static_cast<float>(fine);
  const float scale = 1.0F / static_cast<float>(1 << fine);
  Colour sharp = bilinear(levels_[fine], scale, u, v);
  if (share <= 0.0F) return sharp;
  return (1.0F - share) * sharp + share * bilinear(levels_[fine + 1], 0.5F * scale, u, v);
}

}  // namespace weft::scene
