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

std::vector<float> greys_of(const Picture& picture) {
  std::vector<float> greys;
  greys.reserve(to_index(picture.width + 1) * to_index(picture.height + 1));
  for (int y = 0; y <= picture.height; ++y) {
    ask_to_go_on();
    for (int x = 0; x <= picture.width; ++x) {
      greys.push_back(
          picture.at(std::min(x, picture.width - 1), std::min(y, picture.height - 1))[0]);
    }
  }
  return greys;
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
  for (const Picture& level : levels_)
    greys_.push_back(is_grey ? greys_of(level) : std::vector<float>());
}

MipTexture::Sampler MipTexture::sampler(float texels) const {
  const auto coarsest = static_cast<float>(levels_.size() - 1);
  const float depth = texels > 1.0F ? std::min(std::log2(texels), coarsest) : 0.0F;
  const auto fine = to_index(depth);
  const float scale = 1.0F / static_cast<float>(1 << fine);
  const std::size_t coarse = std::min(fine + 1, levels_.size() - 1);
  return {Level(levels_[fine], greys_[fine], scale),
          Level(levels_[coarse], greys_[coarse], 0.5F * scale), depth - static_cast<float>(fine)};
}

}  // namespace weft::scene
