// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

#include "session.hpp"
#include "tests/adversarial_images.hpp"
#include "tests/kernel_runner.hpp"

namespace weft::sift_gpu {

/// Layers of octaves, with guards before, between and behind the octaves.
class SmallPyramid {
 public:
  explicit SmallPyramid(std::vector<std::vector<reference::Plane>> octaves)
      : layers_(std::move(octaves)) {
    for (const std::vector<reference::Plane>& layers : layers_) {
      std::vector<float> values;
      for (const reference::Plane& layer : layers) {
        const std::vector<float> more = reference::floats_of(layer);
        values.insert(values.end(), more.begin(), more.end());
      }
      octaves_.push_back({levels_.size() + Guarded::kGuard,
                          static_cast<std::int32_t>(layers.front().cols()),
                          static_cast<std::int32_t>(layers.front().rows())});
      const Guarded guarded(values);
      levels_.insert(levels_.end(), guarded.all().begin(), guarded.all().end());
    }
  }

  const std::vector<float>& levels() const { return levels_; }
  const std::vector<Octave>& octaves() const { return octaves_; }
  const std::vector<std::vector<reference::Plane>>& layers() const { return layers_; }
  const reference::Plane& layer(const Spot& spot) const {
    return layers_.at(to_index(spot.octave)).at(to_index(spot.layer));
  }

 private:
  std::vector<std::vector<reference::Plane>> layers_;
  std::vector<Octave> octaves_;
  std::vector<float> levels_;
};

inline Spot spot_at(double x, double y, double scale, double angle_rad = 0.0) {
  return {static_cast<float>(x),
          static_cast<float>(y),
          static_cast<float>(scale),
          static_cast<float>(angle_rad),
          0.1F,
          0,
          0,
          0};
}

/// Two octaves of two layers: blurred noise and blobs. Gradients of whole numbers would often lie
/// on the border of two bins.
inline SmallPyramid noise_and_blobs(std::uint64_t seed) {
  const Eigen::VectorXd weights = reference::gaussian(0.8, 3);
  std::vector<std::vector<reference::Plane>> octaves;
  for (const Size size : {Size{61, 47}, Size{13, 17}}) {
    std::vector<reference::Plane>& layers = octaves.emplace_back();
    for (const reference::Plane& image : {white_noise(size, seed), blobs(size, seed)}) {
      layers.push_back(reference::rounded(reference::convolved(image, weights, weights)));
    }
  }
  return SmallPyramid(octaves);
}

/// Spots anywhere from the sixth pixel on, in all layers; a tenth of them larger than any image.
inline std::vector<Spot> random_spots(const SmallPyramid& pyramid, int count, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<Spot> spots;
  for (int i = 0; i < count; ++i) {
    const std::uint32_t octave = rng.below(2);
    const Octave& size = pyramid.octaves()[octave];
    Spot spot = spot_at(rng.uniform(4.5, size.width - 5.5), rng.uniform(4.5, size.height - 5.5),
                        i % 10 == 0 ? rng.uniform(20.0, 40.0) : rng.uniform(0.8, 5.0),
                        rng.uniform(0.0, 6.283));
    spot.octave = static_cast<std::int32_t>(octave);
    spot.layer = static_cast<std::int32_t>(rng.below(2));
    spots.push_back(spot);
  }
  return spots;
}

/// Layers on which gradients are zero, lie along an axis or change their sign from pixel to pixel,
/// with their names; noise and blobs are blurred as above. "Stripes" has the largest gradients of
/// one direction that there are: two columns at 0, two at 255.
inline std::vector<std::pair<std::string, SmallPyramid>> adversarial_layers(Size size,
                                                                            std::uint64_t seed) {
  const Eigen::VectorXd weights = reference::gaussian(0.8, 3);
  std::vector<std::pair<std::string, SmallPyramid>> layers;
  for (const auto& [name, image] : adversarial_images(size, seed)) {
    const bool blurred = name == "white noise" || name == "blobs";
    const reference::Plane layer =
        blurred ? reference::rounded(reference::convolved(image, weights, weights)) : image;
    layers.emplace_back(name, SmallPyramid({{layer}}));
  }
  layers.emplace_back(
      "stripes",
      SmallPyramid({{reference::Plane::NullaryExpr(
          size.height, size.width, [](auto, auto x) { return x % 4 < 2 ? 0.0 : 255.0; })}}));
  return layers;
}

/// An even image, and long ones of the least height and width in which extrema are looked for, and
/// less.
inline const std::vector<Size> kLayerSizes{{64, 48}, {8192, 11}, {11, 8192}, {8192, 3}, {3, 8192}};

/// Spots all over a layer, on its border pixels too, and on and beside the middle, where the
/// bright pixel and the step are.
inline std::vector<Spot> spots_all_over(Size size, int count, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<Spot> spots;
  for (int i = 0; i < count; ++i) {
    const double scale = i % 5 == 0 ? rng.uniform(8.0, 16.0) : rng.uniform(0.8, 5.0);
    const double angle_rad = rng.uniform(0.0, 6.283);
    const bool in_the_middle = i % 2 == 0;
    const double x = in_the_middle ? size.width / 2 + rng.uniform(-3.0, 3.0)
                                   : rng.uniform(0.0, size.width - 1.0);
    const double y = in_the_middle ? size.height / 2 + rng.uniform(-3.0, 3.0)
                                   : rng.uniform(0.0, size.height - 1.0);
    spots.push_back(spot_at(std::clamp(x, 0.0, size.width - 1.0),
                            std::clamp(y, 0.0, size.height - 1.0), scale, angle_rad));
  }
  return spots;
}

}  // namespace weft::sift_gpu
