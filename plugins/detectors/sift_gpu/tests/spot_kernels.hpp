// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>
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
    return layers_.at(static_cast<std::size_t>(spot.octave))
        .at(static_cast<std::size_t>(spot.layer));
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
      const reference::Plane blurred = reference::convolved(image, weights, weights);
      layers.push_back(reference::plane_of(reference::floats_of(blurred).data(), size.width,
                                           size.height));  // rounded to floats, as the kernel's
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

}  // namespace weft::sift_gpu
