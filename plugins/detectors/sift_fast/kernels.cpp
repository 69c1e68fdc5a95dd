// SPDX-License-Identifier: Apache-2.0
#include "kernels.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>

namespace weft::sift_fast {
namespace {

constexpr double kCameraBlurPx = 0.5;
constexpr double kLeastVariance = 0.01;
/// Where Gaussians are cut off.
constexpr double kCutSigmas = 3.0;

/// Samples of a Gaussian from the middle on; with their mirror images they make 1.
std::vector<double> samples(double sigma_px, int radius) {
  std::vector<double> values;
  double sum = 0.0;
  for (int i = 0; i <= radius; ++i) {
    values.push_back(std::exp(-0.5 * i * i / (sigma_px * sigma_px)));
    sum += (i == 0 ? 1.0 : 2.0) * values.back();
  }
  for (double& value : values) value /= sum;
  return values;
}

double variance(const std::vector<double>& weights) {
  double sum = 0.0;
  for (std::size_t i = 1; i < weights.size(); ++i) {
    sum += 2.0 * static_cast<double>(i * i) * weights[i];
  }
  return sum;
}

/// Weights with the variance sigma^2 although they are few: a Gaussian that is a little wider, cut
/// off.
std::vector<double> weights(double sigma_px) {
  const int radius = std::max(static_cast<int>(std::ceil(kCutSigmas * sigma_px)), 1);
  double narrow = 0.5 * sigma_px, wide = 2.0 * sigma_px + 1.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (narrow + wide);
    (variance(samples(middle, radius)) < sigma_px * sigma_px ? narrow : wide) = middle;
  }
  return samples(narrow, radius);
}

std::int16_t rounded(double weight) {
  return static_cast<std::int16_t>(std::min(std::lrint(weight * kOne), long{kOne - 1}));
}

double blur_between(double before, double after) {
  return std::sqrt(std::max(after * after - before * before, kLeastVariance));
}

}  // namespace

Taps gaussian(double sigma_px) {
  Taps taps;
  for (const double weight : weights(sigma_px)) taps.push_back(rounded(2.0 * weight));
  while (taps.size() > 1 && taps.back() == 0) taps.pop_back();
  int rest = kOne;
  for (std::size_t i = 1; i < taps.size(); ++i) rest -= taps[i];
  taps[0] = static_cast<std::int16_t>(std::min(rest, kOne - 1));
  return taps;
}

std::vector<std::int16_t> doubling_gaussian(double sigma_px) {
  const std::vector<double> blur = weights(sigma_px);
  const auto radius = static_cast<int>(blur.size()) - 1;
  const int reach = (radius + 2) / 2;
  std::vector<double> sums(to_index(2 * reach + 1), 0.0);
  for (int i = -radius; i <= radius; ++i) {
    // Sample i of the enlarged row lies a quarter beside sample `near` of the row.
    const int near = static_cast<int>(std::floor(0.5 * i)), odd = i - 2 * near;
    const int far = odd != 0 ? near + 1 : near - 1;
    sums[to_index(near + reach)] += 0.75 * blur[to_index(std::abs(i))];
    sums[to_index(far + reach)] += 0.25 * blur[to_index(std::abs(i))];
  }
  std::vector<std::int16_t> taps;
  int rest = kOne;
  for (const double sum : sums) {
    taps.push_back(rounded(sum));
    rest -= taps.back();
  }
  std::int16_t& middle = taps[to_index(reach)];
  middle = static_cast<std::int16_t>(std::min(middle + rest, kOne - 1));
  return taps;
}

Blurs::Blurs(const Settings& settings) : layers(settings.octave_layers + 3) {
  const double sigma = settings.sigma_px;
  if (settings.upsample) {
    doubling = doubling_gaussian(blur_between(2.0 * kCameraBlurPx, sigma));
  } else {
    first = gaussian(blur_between(kCameraBlurPx, sigma));
  }
  const double step = std::exp2(1.0 / settings.octave_layers);
  steps.emplace_back();
  for (int i = 1; i < layers; ++i) {
    const double before = std::pow(step, i - 1) * sigma;
    steps.push_back(gaussian(blur_between(before, before * step)));
  }
}

}  // namespace weft::sift_fast
