// SPDX-License-Identifier: Apache-2.0
#include "orientation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <weft/core/index.hpp>

#include "gradients.hpp"

namespace weft::sift_fast {
namespace {

constexpr float kSigmas = 1.5F;  ///< standard deviation of the window, in that of the keypoint
constexpr float kPeakRatio = 0.8F;
constexpr float kTwoPi = 2.0F * std::numbers::pi_v<float>;

/// exp(-i^2 / (2 sigma^2)) for i from 0 on.
void gaussian_weights(double sigma, std::vector<float>& weights) {
  const double once = std::exp(-0.5 / (sigma * sigma)), twice = once * once;
  double value = 1.0, ratio = once;
  for (float& weight : weights) {
    weight = static_cast<float>(value);
    value *= ratio;
    ratio *= twice;
  }
}

}  // namespace

void Orientation::add_gradients(const Plane& layer, const Spot& spot) {
  for (auto& sums : sums_) std::fill(std::begin(sums), std::end(sums), 0.0F);
  const auto centre_x = static_cast<int>(std::lrint(spot.x));
  const auto centre_y = static_cast<int>(std::lrint(spot.y));
  const float sigma = kSigmas * spot.scale;
  const auto radius = static_cast<int>(std::lrint(3.0F * sigma));
  weights_.resize(to_index(radius + 1));
  gaussian_weights(static_cast<double>(sigma), weights_);
  const int left = std::max(centre_x - radius, 1);
  const int right = std::min(centre_x + radius, layer.width - 2);
  const int top = std::max(centre_y - radius, 1);
  const int bottom = std::min(centre_y + radius, layer.height - 2);
  const Window window{layer.row(top) + left, layer.stride, to_index(right - left + 1),
                      to_index(bottom - top + 1)};
  const std::size_t row_length = padded(window.width);
  across_.assign(row_length, 0.0F);
  down_.resize(window.height);
  for (int x = left; x <= right; ++x) {
    across_[to_index(x - left)] = weights_[to_index(std::abs(x - centre_x))];
  }
  for (int y = top; y <= bottom; ++y) {
    down_[to_index(y - top)] = weights_[to_index(std::abs(y - centre_y))];
  }
  if (lengths_.size() < row_length * window.height) {
    lengths_.resize(row_length * window.height);
    directions_.resize(row_length * window.height);
  }
  weighted_gradients(window, across_.data(), down_.data(), kBins, lengths_.data(),
                     directions_.data());
  for (std::size_t y = 0; y < window.height; ++y) {
    const float* lengths = lengths_.data() + y * row_length;
    const std::uint16_t* directions = directions_.data() + y * row_length;
    for (std::size_t x = 0; x < window.width; ++x) sums_[x % 4][directions[x]] += lengths[x];
  }
}

std::span<const float> Orientation::angles(const Plane& layer, const Spot& spot) {
  add_gradients(layer, spot);
  float sums[kBins], smooth[kBins];
  for (int i = 0; i < kBins; ++i)
    sums[i] = (sums_[0][i] + sums_[1][i]) + (sums_[2][i] + sums_[3][i]);
  const auto around = [](const float* bins, int i) { return bins[(i + kBins) % kBins]; };
  for (int i = 0; i < kBins; ++i) {
    smooth[i] = (around(sums, i - 2) + around(sums, i + 2)) * (1.0F / 16.0F) +
                (around(sums, i - 1) + around(sums, i + 1)) * (4.0F / 16.0F) +
                sums[i] * (6.0F / 16.0F);
  }
  const float* highest = std::max_element(std::begin(smooth), std::end(smooth));
  const float least = kPeakRatio * *highest;
  std::size_t count = 0;
  for (int i = 0; i < kBins; ++i) {
    const float here = smooth[i], before = around(smooth, i - 1), after = around(smooth, i + 1);
    if (!(here > before && here > after && here >= least)) continue;
    const float peak =
        static_cast<float>(i) + 0.5F * (before - after) / (before - 2.0F * here + after);
    float angle = peak * (kTwoPi / kBins);
    if (angle < 0.0F) angle += kTwoPi;
    if (angle >= kTwoPi) angle -= kTwoPi;
    angles_[count++] = angle;
  }
  // No bin stands out where several are equal.
  if (count == 0) {
    angles_[count++] = static_cast<float>(highest - std::begin(smooth)) * (kTwoPi / kBins);
  }
  std::sort(angles_, angles_ + count);
  return {angles_, count};
}

}  // namespace weft::sift_fast
