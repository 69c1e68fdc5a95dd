// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <weft/core/index.hpp>

#include "session.hpp"
#include "tests/adversarial_images.hpp"
#include "tests/kernel_runner.hpp"

namespace weft::sift_gpu {
namespace {

using reference::Extremum;
using reference::Plane;

constexpr std::uint64_t kLayerSeed = 43;

/// The output of the kernel: `count` is the number of keypoints, and `spots` has those that found
/// room.
struct Found {
  int count;
  std::vector<Spot> spots;
};

/// How the kernel's extrema differ from the reference's.
struct Difference {
  std::size_t common = 0, only_kernel = 0, only_reference = 0;
  double place_px = 0.0, scale_ratio = 0.0, response = 0.0;  ///< largest of those in common

  void add(const Difference& other) {
    common += other.common;
    only_kernel += other.only_kernel;
    only_reference += other.only_reference;
    place_px = std::max(place_px, other.place_px);
    scale_ratio = std::max(scale_ratio, other.scale_ratio);
    response = std::max(response, other.response);
  }
};

void print(const Difference& d) {
  std::printf(
      "%zu common, %zu of the kernel only, %zu of the reference only; largest difference "
      "%.2g px, scale %.2g, response %.2g\n",
      d.common, d.only_kernel, d.only_reference, d.place_px, d.scale_ratio, d.response);
}

class ExtremaKernel : public ::testing::Test {
 protected:
  static constexpr int kOctave = 3;
  static constexpr int kRoom = 20000;

  Found run(const std::vector<Plane>& layers, const Settings& settings, int capacity = kRoom) {
    std::vector<float> pyramid;
    for (const Plane& layer : layers) {
      const std::vector<float> values = reference::floats_of(layer);
      pyramid.insert(pyramid.end(), values.begin(), values.end());
    }
    const cl::Buffer levels = runner_.upload(Guarded(pyramid).all());
    const std::vector<Spot> room(to_index(capacity) + 10, kUntouched);
    const cl::Buffer spots = runner_.upload(room);
    const cl::Buffer count = runner_.upload(std::vector<cl_int>{0});
    const auto width = static_cast<int>(layers.front().cols());
    const auto height = static_cast<int>(layers.front().rows());
    runner_.over_pixels("extrema", width, height, levels, static_cast<cl_ulong>(Guarded::kGuard),
                        width, height, kOctave, settings.octave_layers,
                        static_cast<float>(settings.sigma_px),
                        static_cast<float>(settings.contrast_threshold),
                        static_cast<float>(settings.edge_threshold), spots, count, capacity);
    Found found{runner_.download<cl_int>(count, 1).front(), {}};
    found.spots = runner_.download<Spot>(spots, room.size());
    const auto used = to_index(std::min(found.count, capacity));
    for (std::size_t i = used; i < room.size(); ++i) EXPECT_EQ(found.spots[i], kUntouched);
    found.spots.resize(used);
    return found;
  }

  /// Pairs each spot with the nearest extremum of its layer that is free.
  Difference difference(const std::vector<Plane>& layers, const Settings& settings) {
    std::vector<Extremum> expected = reference::extrema(layers, settings);
    Difference result;
    for (const Spot& spot : run(layers, settings).spots) {
      EXPECT_EQ(spot.octave, kOctave);
      EXPECT_EQ(spot.angle, 0.0F);
      const auto distance = [&](const Extremum& e) {
        return std::max(std::abs(e.x - spot.x), std::abs(e.y - spot.y));
      };
      auto nearest = expected.end();
      for (auto e = expected.begin(); e != expected.end(); ++e) {
        if (e->layer != spot.layer || distance(*e) > kSamePlacePx) continue;
        if (nearest == expected.end() || distance(*e) < distance(*nearest)) nearest = e;
      }
      if (nearest == expected.end()) {
        ++result.only_kernel;
        continue;
      }
      result.add({1, 0, 0, distance(*nearest), std::abs(spot.scale / nearest->scale - 1.0),
                  std::abs(spot.response - nearest->response)});
      expected.erase(nearest);
    }
    result.only_reference = expected.size();
    return result;
  }

  static constexpr double kSamePlacePx = 0.05;
  static constexpr Spot kUntouched{-1.0F, -2.0F, -3.0F, -4.0F, -5.0F, -6, -7, -8};

  KernelRunner runner_;
};

/// Layers that have nothing to do with one another: extrema everywhere, and long ways to them.
std::vector<Plane> noise_layers(Size size, int octave_layers, std::uint64_t seed) {
  std::vector<Plane> layers;
  for (int l = 0; l < octave_layers + 3; ++l) {
    layers.push_back(white_noise(size, 100 * seed + static_cast<std::uint64_t>(l)));
  }
  return layers;
}

TEST_F(ExtremaKernel, FindsWhatBruteForceFindsInNoise) {
  std::printf("layers of noise from seed %d\n", static_cast<int>(kLayerSeed));
  Difference all;
  for (const Size size : {Size{64, 48}, Size{13, 17}, Size{8192, 12}, Size{12, 8192}}) {
    for (const Settings& settings :
         {Settings{}, Settings{.octave_layers = 1}, Settings{.octave_layers = 5},
          Settings{.contrast_threshold = 0.0, .edge_threshold = 1000.0},
          Settings{.contrast_threshold = 0.5, .edge_threshold = 2.0}}) {
      all.add(difference(noise_layers(size, settings.octave_layers, kLayerSeed), settings));
    }
  }
  print(all);
  EXPECT_GT(all.common, 1000U);
  // Rounding may decide where a value equals a threshold.
  EXPECT_LE(all.only_kernel + all.only_reference, 3U);
  // Floats near 8192 differ by 0.0005.
  EXPECT_LT(all.place_px, 5e-4);
  EXPECT_LT(all.scale_ratio, 1e-5);
  EXPECT_LT(all.response, 1e-6);
}

TEST_F(ExtremaKernel, FindsWhatBruteForceFindsInScaleSpaces) {
  std::printf("noise and blobs from seed %d\n", static_cast<int>(kLayerSeed));
  const Settings settings{.contrast_threshold = 0.02};
  for (const Size size : {Size{96, 80}, Size{1, 7}, Size{2, 2}, Size{13, 17}, Size{640, 1}}) {
    for (const auto& [name, image] : adversarial_images(size, kLayerSeed)) {
      Difference result;
      for (const std::vector<Plane>& layers : reference::pyramid(image, settings)) {
        result.add(difference(layers, settings));
      }
      std::printf("%d x %d, %s: ", size.width, size.height, name.c_str());
      print(result);
      EXPECT_EQ(result.only_kernel + result.only_reference, 0U);
      EXPECT_LT(result.place_px, 1e-3);
      EXPECT_LT(result.scale_ratio, 1e-4);
      EXPECT_LT(result.response, 1e-6);
      if (name == "blobs" && size.width == 96) {
        EXPECT_GT(result.common, 50U);
      }
    }
  }
}

/// A Gaussian blob in each layer, computed from its formula: a blob of sigma s, blurred by t, is
/// one of sqrt(s^2 + t^2) with s^2 / (s^2 + t^2) of its height. With a factor k between layers, the
/// difference of two is extremal at the finer one's t = s / sqrt(k), with (k - 1) / (k + 1) of the
/// height.
struct PlantedBlob {
  double x, y;
  double layer;  ///< where it is extremal
  double height = 200.0;
  Settings settings{};

  double k() const { return std::exp2(1.0 / settings.octave_layers); }
  double scale() const { return settings.sigma_px * std::pow(k(), layer); }
  double response() const { return std::abs(height) / 255.0 * (k() - 1.0) / (k() + 1.0); }

  std::vector<Plane> layers(Size size) const {
    std::vector<Plane> result;
    const double variance = scale() * scale() * k();
    for (int l = 0; l < settings.octave_layers + 3; ++l) {
      const double blurred = variance + std::pow(settings.sigma_px * std::pow(k(), l), 2);
      result.push_back(Plane::NullaryExpr(size.height, size.width, [&](auto v, auto u) {
        const double dx = static_cast<double>(u) - x, dy = static_cast<double>(v) - y;
        return 128.0 + height * variance / blurred * std::exp(-0.5 * (dx * dx + dy * dy) / blurred);
      }));
    }
    return result;
  }
};

TEST_F(ExtremaKernel, FindsABlobWhereItWasPlanted) {
  double place_px = 0.0, scale_ratio = 0.0, response_ratio = 0.0;
  for (const double height : {100.0, -100.0}) {
    for (const PlantedBlob& blob :
         {PlantedBlob{30.0, 25.0, 2.0}, PlantedBlob{30.3, 24.8, 1.2}, PlantedBlob{29.6, 25.45, 2.7},
          PlantedBlob{33.25, 21.75, 3.3},
          PlantedBlob{30.4, 25.4, 3.9, 0.0, Settings{.octave_layers = 5}}}) {
      PlantedBlob planted = blob;
      planted.height = height;
      const Found found = run(planted.layers({64, 48}), planted.settings);
      ASSERT_EQ(found.count, 1) << planted.x << " " << planted.layer;
      const Spot& spot = found.spots.front();
      place_px = std::max({place_px, std::abs(spot.x - planted.x), std::abs(spot.y - planted.y)});
      scale_ratio = std::max(scale_ratio, std::abs(spot.scale / planted.scale() - 1.0));
      response_ratio = std::max(response_ratio, std::abs(spot.response / planted.response() - 1.0));
      EXPECT_EQ(spot.layer, std::lrint(planted.layer));
    }
  }
  std::printf("planted blobs: largest error %.3f px, scale %.4f, response %.4f\n", place_px,
              scale_ratio, response_ratio);
  // The error of a parabola through three samples of a Gaussian.
  EXPECT_LT(place_px, 0.05);
  EXPECT_LT(scale_ratio, 0.02);
  EXPECT_LT(response_ratio, 0.01);
}

TEST_F(ExtremaKernel, LooksFromTheSixthPixelOnAtEachSide) {
  constexpr Size kSize{40, 30};
  for (const auto& [x, y, expected] :
       {std::tuple{5.0, 15.0, 1}, std::tuple{4.0, 15.0, 0}, std::tuple{34.0, 15.0, 1},
        std::tuple{35.0, 15.0, 0}, std::tuple{20.0, 5.0, 1}, std::tuple{20.0, 4.0, 0},
        std::tuple{20.0, 24.0, 1}, std::tuple{20.0, 25.0, 0}}) {
    const PlantedBlob blob{x, y, 1.0};
    EXPECT_EQ(run(blob.layers(kSize), blob.settings).count, expected) << x << " " << y;
  }
}

TEST_F(ExtremaKernel, FindsNothingWhereNothingIsExtremal) {
  constexpr Size kSize{64, 48};
  const auto layers_of = [](const Plane& plane) { return std::vector<Plane>(6, plane); };
  const Settings anything{.contrast_threshold = 0.0, .edge_threshold = 1000.0};
  EXPECT_EQ(run(layers_of(Plane::Constant(48, 64, 77.0)), anything).count, 0);

  std::vector<Plane> rising = layers_of(Plane::Constant(48, 64, 0.0));
  for (std::size_t l = 0; l < rising.size(); ++l)
    rising[l].array() += 30.0 * static_cast<double>(l);
  EXPECT_EQ(run(rising, anything).count, 0) << "equal differences everywhere";

  for (const auto& [a, b] : {std::pair{3.0, 0.0}, std::pair{0.0, -3.0}, std::pair{1.7, 2.1}}) {
    const Plane ramp = Plane::NullaryExpr(kSize.height, kSize.width, [&](auto y, auto x) {
      return 127.0 + a * (static_cast<double>(x) - 32.0) + b * (static_cast<double>(y) - 24.0);
    });
    EXPECT_EQ(run(layers_of(ramp), anything).count, 0);
    const Settings usual{.upsample = false};
    EXPECT_EQ(run(reference::pyramid(ramp, usual).front(), usual).count, 0) << "blurred ramp";
  }
}

TEST_F(ExtremaKernel, GoesOnCountingBeyondItsRoom) {
  const std::vector<Plane> layers = noise_layers({64, 48}, 3, kLayerSeed);
  const Found all = run(layers, {});
  ASSERT_GT(all.count, 10);
  ASSERT_EQ(all.count, static_cast<int>(all.spots.size()));
  for (const int capacity : {0, 1, all.count - 1}) {
    const Found some = run(layers, {}, capacity);
    EXPECT_EQ(some.count, all.count);
    for (const Spot& spot : some.spots) {
      EXPECT_NE(std::find(all.spots.begin(), all.spots.end(), spot), all.spots.end());
    }
  }
}

}  // namespace
}  // namespace weft::sift_gpu
