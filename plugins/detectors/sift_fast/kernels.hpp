// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "settings.hpp"

namespace weft::sift_fast {

/// Weights are whole numbers: kOne stands for 1.
constexpr int kOne = 1 << 15;

/// Weights of a symmetric kernel from its middle on, all but the middle doubled: that and the
/// others make kOne.
using Taps = std::vector<std::int16_t>;

/// A Gaussian sampled at whole numbers, to three sigmas; its variance is that of all of it.
Taps gaussian(double sigma_px);

/// The weights for the even samples of a row that is enlarged twice, linearly and with pixel edges
/// aligned, and then blurred by `sigma_px` (of the enlarged row). They apply to the samples of the
/// row itself from -m to m, 2 m + 1 of them, and sum to kOne. Reversed, they are the weights for
/// the odd samples.
std::vector<std::int16_t> doubling_gaussian(double sigma_px);

/// How each layer of an octave comes from the one before; the same in all octaves.
struct Blurs {
  explicit Blurs(const Settings& settings);

  int layers = 0;                      ///< Gaussian layers of an octave
  std::vector<std::int16_t> doubling;  ///< first layer from the image, if it is enlarged
  Taps first;                          ///< first layer from the image, if it is not
  std::vector<Taps> steps;             ///< [layers] each from the one before; the first is empty
};

}  // namespace weft::sift_fast
