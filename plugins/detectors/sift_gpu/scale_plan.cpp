// SPDX-License-Identifier: Apache-2.0
#include "scale_plan.hpp"

#include <algorithm>
#include <cmath>

namespace weft::sift_gpu {
namespace {

constexpr double kCameraBlurPx = 0.5;
constexpr double kLeastVariance = 0.01;

/// Adds a Gaussian of about four sigmas to each side, its sum 1.
Blur add_gaussian(double sigma_px, std::vector<float>& taps) {
  const int radius = (static_cast<int>(std::lrint(8.0 * sigma_px + 1.0)) | 1) / 2;
  std::vector<double> weights;
  double sum = 0.0;
  for (int i = 0; i <= radius; ++i) {
    weights.push_back(std::exp(-0.5 * i * i / (sigma_px * sigma_px)));
    sum += i == 0 ? weights.back() : 2.0 * weights.back();
  }
  const Blur blur{static_cast<int>(taps.size()), radius};
  for (const double weight : weights) taps.push_back(static_cast<float>(weight / sum));
  return blur;
}

}  // namespace

ScalePlan::ScalePlan(int of_width, int of_height, const Settings& settings)
    : image_width(of_width),
      image_height(of_height),
      width(of_width << (settings.upsample ? 1 : 0)),
      height(of_height << (settings.upsample ? 1 : 0)) {
  const double sigma = settings.sigma_px;
  const double had = kCameraBlurPx * (settings.upsample ? 2.0 : 1.0);
  blurs.push_back(
      add_gaussian(std::sqrt(std::max(sigma * sigma - had * had, kLeastVariance)), taps));
  const double step = std::exp2(1.0 / settings.octave_layers);
  for (int i = 1; i < settings.octave_layers + 3; ++i) {
    const double before = std::pow(step, i - 1) * sigma, after = before * step;
    blurs.push_back(add_gaussian(std::sqrt(after * after - before * before), taps));
  }

  const auto count = std::lrint(std::log2(static_cast<double>(std::min(width, height))) - 1.0);
  int octave_width = width, octave_height = height;
  for (long i = 0; i < count; ++i, octave_width /= 2, octave_height /= 2) {
    octaves.push_back({pyramid_size, octave_width, octave_height});
    pyramid_size += blurs.size() * static_cast<std::uint64_t>(octave_width) *
                    static_cast<std::uint64_t>(octave_height);
  }
}

}  // namespace weft::sift_gpu
