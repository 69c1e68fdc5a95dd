// SPDX-License-Identifier: Apache-2.0
#include "common/scene/sensor.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::scene {
namespace {

constexpr std::size_t kPool = 65536;

/// Draws from the pool, two for each random number.
class NoiseSource {
 public:
  NoiseSource(const std::vector<float>& pool, Rng rng) : pool_(pool), rng_(rng) {}

  float next() {
    if (pool_.empty()) return 0.0F;
    has_half_ = !has_half_;
    if (has_half_) {
      bits_ = rng_.next_u32();
      return pool_[bits_ & 0xFFFFU];
    }
    return pool_[bits_ >> 16U];
  }

 private:
  const std::vector<float>& pool_;
  Rng rng_;
  std::uint32_t bits_ = 0;
  bool has_half_ = false;
};

}  // namespace

Sensor::Sensor(double blur_px, double noise_grey) : blur_px_(blur_px) {
  if (noise_grey <= 0.0) return;
  noise_.reserve(kPool);
  constexpr std::uint64_t kAnySeed = 20;
  Rng rng(kAnySeed);
  while (noise_.size() < kPool) noise_.push_back(static_cast<float>(noise_grey * rng.normal()));
}

Array<std::uint8_t> Sensor::expose(const Picture& light, bool is_grey, Rng rng) const {
  const cv::Mat sharp(light.height, light.width, CV_32FC4,
                      const_cast<Colour*>(light.pixels.data()));
  cv::Mat seen = sharp;
  if (blur_px_ > 0.0) {
    const int reach = static_cast<int>(std::ceil(3.0 * blur_px_));
    cv::GaussianBlur(sharp, seen, {2 * reach + 1, 2 * reach + 1}, blur_px_, blur_px_,
                     cv::BORDER_REPLICATE);
  }
  const int channels = is_grey ? 1 : 3;
  Array<std::uint8_t> pixels = is_grey ? Array<std::uint8_t>({light.height, light.width})
                                       : Array<std::uint8_t>({light.height, light.width, 3});
  NoiseSource noise(noise_, rng);
  std::uint8_t* target = pixels.data();
  for (int y = 0; y < seen.rows; ++y) {
    ask_to_go_on();
    const auto* row = seen.ptr<cv::Vec4f>(y);
    for (int x = 0; x < seen.cols; ++x) {
      for (int k = 0; k < channels; ++k) {
        *target++ = cv::saturate_cast<std::uint8_t>(row[x][k] + noise.next());
      }
    }
  }
  return pixels;
}

Picture without_colour(Picture picture) {
  for (Colour& c : picture.pixels) {
    c = Colour::Constant(0.114F * c[0] + 0.587F * c[1] + 0.299F * c[2]);
  }
  return picture;
}

}  // namespace weft::scene
