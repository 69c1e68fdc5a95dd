// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <weft/core/index.hpp>

#include "tests/spot_kernels.hpp"

namespace weft::sift_gpu {
namespace {

using reference::Plane;
using Descriptor = std::array<double, 128>;

class DescriptionsKernel : public ::testing::Test {
 protected:
  std::vector<Descriptor> run(const SmallPyramid& pyramid, const std::vector<Spot>& spots) {
    constexpr std::uint8_t kUntouched = 201;
    const std::size_t count = 128 * spots.size();
    const cl::Buffer rows = runner_.upload(std::vector<std::uint8_t>(count + 128, kUntouched));
    runner_.over_spots("descriptions", spots.size(), runner_.upload(pyramid.levels()),
                       runner_.upload(pyramid.octaves()), runner_.upload(spots), rows);
    const std::vector<std::uint8_t> written = runner_.download<std::uint8_t>(rows, count + 128);
    EXPECT_EQ(std::count(written.end() - 128, written.end(), kUntouched), 128);
    std::vector<Descriptor> descriptors(spots.size());
    for (std::size_t i = 0; i < count; ++i) descriptors[i / 128][i % 128] = written[i];
    return descriptors;
  }

  Descriptor describe(const Plane& layer, const Spot& spot) {
    return run(SmallPyramid({{layer}}), {spot}).front();
  }

  KernelRunner runner_;
};

/// Largest difference of the elements.
double largest_difference(const Descriptor& a, const Descriptor& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

double distance(const Descriptor& a, const Descriptor& b) {
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(squares);
}

TEST_F(DescriptionsKernel, AreTheReferencesInTwoOctavesOfNoiseAndBlobs) {
  constexpr std::uint64_t kSeed = 61;
  std::printf("noise and places from seed %d\n", static_cast<int>(kSeed));
  const SmallPyramid pyramid = noise_and_blobs(kSeed);
  const std::vector<Spot> spots = random_spots(pyramid, 100, kSeed);
  const std::vector<Descriptor> found = run(pyramid, spots);
  double largest = 0.0;
  for (std::size_t i = 0; i < spots.size(); ++i) {
    const Spot& spot = spots[i];
    const Descriptor expected =
        reference::descriptor(pyramid.layer(spot), spot.x, spot.y, spot.scale, spot.angle);
    largest = std::max(largest, largest_difference(found[i], expected));
    EXPECT_NEAR(distance(found[i], {}), 512.0, 10.0) << "a unit vector, but for the cut at 255";
  }
  std::printf("largest difference of an element: %.3f of 255, rounding included\n", largest);
  EXPECT_LE(largest, 1.0);
}

TEST_F(DescriptionsKernel, AreTheReferencesInLayersOfAnySizeWhereGradientsAreZeroOrAlongAnAxis) {
  constexpr std::uint64_t kSeed = 64;
  std::printf("noise and places from seed %d\n", static_cast<int>(kSeed));
  for (const Size size : kLayerSizes) {
    const std::vector<Spot> spots = spots_all_over(size, 30, kSeed);
    for (const auto& [name, pyramid] : adversarial_layers(size, kSeed)) {
      const std::vector<Descriptor> found = run(pyramid, spots);
      double largest = 0.0;
      int zero = 0;
      for (std::size_t i = 0; i < spots.size(); ++i) {
        const Spot& spot = spots[i];
        const Descriptor expected =
            reference::descriptor(pyramid.layer(spot), spot.x, spot.y, spot.scale, spot.angle);
        largest = std::max(largest, largest_difference(found[i], expected));
        zero += expected == Descriptor{} ? 1 : 0;
      }
      std::printf("%d x %d, %s: largest difference %.3f of 255, %d of %zu without gradients\n",
                  size.width, size.height, name.c_str(), largest, zero, spots.size());
      EXPECT_LE(largest, 1.0);
      const bool nothing = name == "flat" || name == "checkerboard";
      EXPECT_EQ(nothing, zero == static_cast<int>(spots.size()));
    }
  }
}

TEST_F(DescriptionsKernel, StayTheSameWhenTheImageMakesAQuarterTurn) {
  constexpr std::uint64_t kSeed = 62;
  std::printf("noise from seed %d\n", static_cast<int>(kSeed));
  const Plane upright = white_noise({50, 50}, kSeed);
  Plane turned(50, 50);  // clockwise on the screen
  for (int y = 0; y < 50; ++y) {
    for (int x = 0; x < 50; ++x) turned(x, 49 - y) = upright(y, x);
  }
  for (const double angle_rad : {0.0, 0.4, 2.5, 5.1}) {
    const Descriptor before = describe(upright, spot_at(23.0, 27.0, 2.2, angle_rad));
    const Descriptor after =
        describe(turned, spot_at(49.0 - 27.0, 23.0, 2.2, angle_rad + 0.5 * std::numbers::pi));
    EXPECT_LE(largest_difference(before, after), 1.0) << angle_rad;
  }
}

TEST_F(DescriptionsKernel, StayNearlyTheSameForAnyTurnAndSize) {
  const auto pattern = [](const Eigen::Vector2d& at) {
    return 120.0 + 40.0 * std::sin(0.45 * at.x()) * std::sin(0.38 * at.y() + 1.0) +
           25.0 * std::sin(0.25 * at.x() + 0.31 * at.y());
  };
  // The pattern around its place `from`, turned and enlarged around the middle of the image.
  const auto describe_turned = [&](const Eigen::Vector2d& from, double turn_rad, double size) {
    const Plane image = Plane::NullaryExpr(121, 121, [&](auto y, auto x) {
      const Eigen::Vector2d at(static_cast<double>(x) - 60.0, static_cast<double>(y) - 60.0);
      return pattern(from + Eigen::Rotation2Dd(-turn_rad) * at / size);
    });
    return describe(image, spot_at(60.0, 60.0, 2.5 * size, 0.8 + turn_rad));
  };
  const Eigen::Vector2d here(3.0, 4.0), elsewhere(9.0, 1.0);
  const Descriptor plain = describe_turned(here, 0.0, 1.0);
  double largest = 0.0;
  for (const double turn_rad : {0.3, 1.0, 2.2, 4.0}) {
    for (const double size : {1.0, 1.4, 2.0}) {
      largest = std::max(largest, distance(describe_turned(here, turn_rad, size), plain));
    }
  }
  const double other = distance(describe_turned(elsewhere, 0.0, 1.0), plain);
  std::printf("of 512: turned and enlarged up to %.1f away, another place %.1f\n", largest, other);
  EXPECT_LT(largest, 0.05 * 512.0);
  EXPECT_GT(other, 0.3 * 512.0);
}

TEST_F(DescriptionsKernel, DoNotChangeWithBrightnessAndContrast) {
  constexpr std::uint64_t kSeed = 63;
  std::printf("noise from seed %d\n", static_cast<int>(kSeed));
  const Plane strong = white_noise({50, 50}, kSeed);
  const Plane weak = (strong.array() * 0.01 + 100.0).matrix();
  const Spot spot = spot_at(25.0, 25.0, 2.0, 1.0);
  EXPECT_LE(largest_difference(describe(strong, spot), describe(weak, spot)), 1.0);
}

TEST_F(DescriptionsKernel, AFlatLayerHasZeros) {
  const Descriptor flat = describe(Plane::Constant(40, 40, 77.0), spot_at(20.0, 20.0, 2.0));
  EXPECT_EQ(flat, Descriptor{});
}

TEST_F(DescriptionsKernel, ARampFillsOneDirectionOfEachCell) {
  const Plane ramp =
      Plane::NullaryExpr(60, 60, [](auto, auto x) { return 2.0 * static_cast<double>(x); });
  for (int direction = 0; direction < 8; ++direction) {
    // A keypoint turned clockwise sees the ramp's direction anticlockwise from its direction.
    const double angle_rad = direction * 0.25 * std::numbers::pi;
    const Descriptor found = describe(ramp, spot_at(30.0, 30.0, 2.0, angle_rad));
    for (int bin = 0; bin < 128; ++bin) {
      const double value = found[to_index(bin)];
      if (bin % 8 == direction) {
        EXPECT_GT(value, 20.0) << direction << " " << bin;
      } else {
        EXPECT_LE(value, 1.0) << direction << " " << bin;
      }
    }
  }
}

}  // namespace
}  // namespace weft::sift_gpu
