// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>
#include <weft/core/rng.hpp>

#include "reference.hpp"

namespace weft::sift_gpu {

struct Size {
  int width, height;
};

/// One pixel, one row or column, less than a Gaussian is wide, odd, much longer than wide.
inline const std::vector<Size> kAdversarialSizes{{1, 1},   {1, 7},    {7, 1},    {2, 2},
                                                 {13, 17}, {8192, 3}, {3, 8192}, {640, 1}};

inline void PrintTo(const Size& size, std::ostream* out) {
  *out << size.width << " x " << size.height;
}

/// Grey levels 0 to 255 that are whole numbers, each drawn uniformly.
inline reference::Plane white_noise(Size size, std::uint64_t seed) {
  Rng rng(seed);
  return reference::Plane::NullaryExpr(size.height, size.width,
                                       [&] { return static_cast<double>(rng.below(256)); });
}

/// Blobs of all sizes, brighter and darker than their surroundings: noise in several blurs.
inline reference::Plane blobs(Size size, std::uint64_t seed) {
  reference::Plane sum = reference::Plane::Constant(size.height, size.width, 127.5);
  for (const int sigma_px : {1, 2, 4}) {
    const Eigen::VectorXd weights = reference::gaussian(sigma_px, 3 * sigma_px);
    const auto noise = white_noise(size, seed + static_cast<std::uint64_t>(sigma_px));
    const reference::Plane centred = (noise.array() - 127.5).matrix();
    sum += 1.5 * sigma_px * reference::convolved(centred, weights, weights);
  }
  return sum.array().rint().cwiseMax(0.0).cwiseMin(255.0);
}

/// The images for the test of each kernel, with names; whole numbers from 0 to 255.
inline std::vector<std::pair<std::string, reference::Plane>> adversarial_images(
    Size size, std::uint64_t seed) {
  const auto drawn = [&](const auto& grey) {
    return reference::Plane(
        reference::Plane::NullaryExpr(size.height, size.width, [&](auto y, auto x) {
          return grey(static_cast<int>(x), static_cast<int>(y)) ? 255.0 : 0.0;
        }));
  };
  return {{"flat", reference::Plane::Constant(size.height, size.width, 77.0)},
          {"one bright pixel",
           drawn([&](int x, int y) { return x == size.width / 2 && y == size.height / 2; })},
          {"a step edge", drawn([&](int x, int) { return x >= size.width / 2; })},
          {"checkerboard", drawn([](int x, int y) { return (x + y) % 2 == 1; })},
          {"white noise", white_noise(size, seed)},
          {"blobs", blobs(size, seed)}};
}

}  // namespace weft::sift_gpu
