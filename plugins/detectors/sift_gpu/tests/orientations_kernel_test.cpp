// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <weft/core/index.hpp>

#include "tests/spot_kernels.hpp"

namespace weft::sift_gpu {
namespace {

using reference::Plane;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kBinWidth = kTurn / 36.0;

double turn_between(double a, double b) { return std::abs(std::remainder(a - b, kTurn)); }

/// A plane of 40 x 40 that rises in a direction, from +x towards +y.
Plane ramp(double angle_rad) {
  return Plane::NullaryExpr(40, 40, [&](auto y, auto x) {
    return 127.0 + 2.0 * (std::cos(angle_rad) * (static_cast<double>(x) - 20.0) +
                          std::sin(angle_rad) * (static_cast<double>(y) - 20.0));
  });
}

class OrientationsKernel : public ::testing::Test {
 protected:
  /// Angles, ascending, for each spot.
  std::vector<std::vector<double>> run(const SmallPyramid& pyramid, std::vector<Spot> spots) {
    for (std::size_t i = 0; i < spots.size(); ++i) spots[i].reserved = static_cast<int>(i);
    const int room = 36 * static_cast<int>(spots.size());
    const auto [count, keypoints] = run(pyramid, spots, room);
    std::vector<std::vector<double>> angles(spots.size());
    for (const Spot& keypoint : keypoints) {
      const auto i = to_index(keypoint.reserved);
      Spot same = keypoint;
      same.angle = spots.at(i).angle;
      EXPECT_EQ(same, spots.at(i)) << "nothing but the angle is new";
      EXPECT_GE(keypoint.angle, 0.0F);
      EXPECT_LT(keypoint.angle, static_cast<float>(kTurn));
      angles[i].push_back(keypoint.angle);
    }
    for (std::vector<double>& of_spot : angles) std::sort(of_spot.begin(), of_spot.end());
    return angles;
  }

  /// How many keypoints there are, and those that found room.
  std::pair<int, std::vector<Spot>> run(const SmallPyramid& pyramid, const std::vector<Spot>& spots,
                                        int capacity) {
    const Spot untouched{-1.0F, -2.0F, -3.0F, -4.0F, -5.0F, -6, -7, -8};
    const std::vector<Spot> room(to_index(capacity) + 10, untouched);
    const cl::Buffer keypoints = runner_.upload(room);
    const cl::Buffer count = runner_.upload(std::vector<cl_int>{0});
    runner_.over_spots("orientations", spots.size(), runner_.upload(pyramid.levels()),
                       runner_.upload(pyramid.octaves()), runner_.upload(spots), keypoints, count,
                       capacity);
    std::vector<Spot> found = runner_.download<Spot>(keypoints, room.size());
    const int there_are = runner_.download<cl_int>(count, 1).front();
    const auto used = to_index(std::min(there_are, capacity));
    for (std::size_t i = used; i < room.size(); ++i) EXPECT_EQ(found[i], untouched);
    found.resize(used);
    return {there_are, found};
  }

  KernelRunner runner_;
};

/// How the kernel's angles differ from the reference's.
struct AngleDifference {
  std::size_t common = 0;     ///< angles
  std::size_t differing = 0;  ///< spots with another number of angles
  double largest_rad = 0.0;
};

AngleDifference difference(const SmallPyramid& pyramid, const std::vector<Spot>& spots,
                           const std::vector<std::vector<double>>& found) {
  AngleDifference result;
  for (std::size_t i = 0; i < spots.size(); ++i) {
    const std::vector<double> expected =
        reference::orientations(pyramid.layer(spots[i]), spots[i].x, spots[i].y, spots[i].scale);
    if (found[i].size() != expected.size()) {
      ++result.differing;
      continue;
    }
    result.common += expected.size();
    for (std::size_t j = 0; j < expected.size(); ++j) {
      result.largest_rad = std::max(result.largest_rad, turn_between(found[i][j], expected[j]));
    }
  }
  std::printf("%zu angles, largest difference %.2g rad; %zu spots of %zu with another number\n",
              result.common, result.largest_rad, result.differing, spots.size());
  return result;
}

TEST_F(OrientationsKernel, AreTheReferencesInTwoOctavesOfNoiseAndBlobs) {
  constexpr std::uint64_t kSeed = 51;
  std::printf("noise and places from seed %d\n", static_cast<int>(kSeed));
  const SmallPyramid pyramid = noise_and_blobs(kSeed);
  const std::vector<Spot> spots = random_spots(pyramid, 400, kSeed);
  const AngleDifference found = difference(pyramid, spots, run(pyramid, spots));
  EXPECT_GT(found.common, spots.size());
  EXPECT_EQ(found.differing, 0U);
  EXPECT_LT(found.largest_rad, 1e-3);
}

TEST_F(OrientationsKernel, AreTheReferencesInLayersOfAnySizeWhereGradientsAreZeroOrAlongAnAxis) {
  constexpr std::uint64_t kSeed = 53;
  std::printf("noise and places from seed %d\n", static_cast<int>(kSeed));
  for (const Size size : kLayerSizes) {
    for (const auto& [name, pyramid] : adversarial_layers(size, kSeed)) {
      std::printf("%d x %d, %s: ", size.width, size.height, name.c_str());
      const std::vector<Spot> spots = spots_all_over(size, 30, kSeed);
      const AngleDifference found = difference(pyramid, spots, run(pyramid, spots));
      EXPECT_EQ(found.differing, 0U);
      EXPECT_LT(found.largest_rad, 1e-3);
      const bool nothing = name == "flat" || name == "checkerboard";
      EXPECT_EQ(nothing, found.common == 0);
    }
  }
}

TEST_F(OrientationsKernel, AreTheDirectionOfARamp) {
  for (int bin = 0; bin < 36; ++bin) {
    const double angle_rad = bin * kBinWidth;
    const SmallPyramid pyramid({{ramp(angle_rad)}});
    const auto found = run(pyramid, {spot_at(20.2, 19.9, 2.0), spot_at(5.0, 34.0, 2.0)});
    for (const std::vector<double>& angles : found) {
      ASSERT_EQ(angles.size(), 1U) << bin;
      EXPECT_LT(turn_between(angles.front(), angle_rad), 1e-4) << bin;
    }
  }
}

TEST_F(OrientationsKernel, AreWithinHalfABinOfTheDirectionOfAnyRamp) {
  constexpr std::uint64_t kSeed = 52;
  std::printf("directions from seed %d\n", static_cast<int>(kSeed));
  Rng rng(kSeed);
  for (int i = 0; i < 30; ++i) {
    const double angle_rad = rng.uniform(0.0, kTurn);
    const auto found = run(SmallPyramid({{ramp(angle_rad)}}), {spot_at(20.0, 20.0, 3.0)});
    ASSERT_EQ(found.front().size(), 1U) << angle_rad;
    EXPECT_LT(turn_between(found.front().front(), angle_rad), 0.5 * kBinWidth + 1e-4);
  }
}

/// A valley along the column 20 whose left side rises `left`, whose right side `right` a pixel.
Plane valley(double left, double right) {
  return Plane::NullaryExpr(40, 40, [&](auto, auto x) {
    const double u = static_cast<double>(x) - 20.0;
    return 100.0 + (u < 0.0 ? -left : right) * u;
  });
}

TEST_F(OrientationsKernel, ThereIsOneForEachPeakOfFourFifthsOfTheHighest) {
  const auto angles = [&](const Plane& plane) {
    return run(SmallPyramid({{plane}}), {spot_at(20.0, 20.0, 2.0)}).front();
  };
  const std::vector<double> both = angles(valley(3.0, 3.0));
  ASSERT_EQ(both.size(), 2U);
  EXPECT_NEAR(both[0], 0.0, 1e-4);
  EXPECT_NEAR(both[1], std::numbers::pi, 1e-4);
  EXPECT_EQ(angles(valley(2.6, 3.0)).size(), 2U);
  const std::vector<double> right = angles(valley(2.0, 3.0));
  ASSERT_EQ(right.size(), 1U);
  EXPECT_NEAR(right[0], 0.0, 1e-4);
  const std::vector<double> left = angles(valley(3.0, 2.0));
  ASSERT_EQ(left.size(), 1U);
  EXPECT_NEAR(left[0], std::numbers::pi, 1e-4);

  const std::vector<double> four = angles(Plane::NullaryExpr(40, 40, [](auto y, auto x) {
    return 4.0 * static_cast<double>(std::max(std::abs(x - 20), std::abs(y - 20)));
  }));
  EXPECT_EQ(four.size(), 4U);
}

TEST_F(OrientationsKernel, AFlatLayerHasNone) {
  const auto found = run(SmallPyramid({{Plane::Constant(40, 40, 77.0)}}), {spot_at(20, 20, 2)});
  EXPECT_TRUE(found.front().empty());
}

TEST_F(OrientationsKernel, AreCountedBeyondTheirRoom) {
  const SmallPyramid pyramid({{valley(3.0, 3.0)}});
  const std::vector<Spot> spots(50, spot_at(20.0, 20.0, 2.0));
  for (const int capacity : {1, 99, 100}) {
    const auto [count, keypoints] = run(pyramid, spots, capacity);
    EXPECT_EQ(count, 100);
    EXPECT_EQ(keypoints.size(), to_index(capacity));
  }
}

}  // namespace
}  // namespace weft::sift_gpu
