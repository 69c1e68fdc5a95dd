// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <array>
#include <iostream>
#include <list>
#include <weft/core/rng.hpp>

#include "common/tests/scenes.hpp"
#include "tests/test_detector.hpp"

namespace weft::onnx {
namespace {

using detectors::constant_image;
using detectors::detect;
using detectors::image_of;
using testing::TestFolder;
using testing::TestMaps;
using weft::testing::input;
using weft::testing::PluginUnderTest;

constexpr double kNear = 1e-3;  // px; positions are rounded to float32

Image black(int width, int height) {
  return image_of(width, height, [](double, double) { return 0.0; });
}

struct OnnxMaps : ::testing::Test {
  TestFolder folder;
  TestMaps network;
  mutable std::list<PluginUnderTest> plugins;  ///< they own the keypoints

  std::string params(const std::string& more = "") const {
    return "{network: " + network.write(folder) + more + "}";
  }
  Keypoints found(const Image& image, const std::string& more = "") const {
    return detect(plugins.emplace_back("detectors/onnx", params(more)), image);
  }
};

TEST_F(OnnxMaps, FindsBrightPixelsWithTheDescriptorsOfTheirPlaces) {
  network.describe_places();
  Image image = black(160, 120);
  const std::array<std::array<int, 2>, 3> places{{{20, 11}, {90, 40}, {131, 40}}};
  for (const auto& [x, y] : places) image.pixels(y, x) = 255;
  const Keypoints keypoints = found(image);
  ASSERT_EQ(keypoints.count(), 3);
  EXPECT_EQ(keypoints.metric, "l2");
  for (std::int64_t n = 0; n < 3; ++n) {
    const auto [x, y] = places[to_index(n)];
    EXPECT_NEAR(keypoints.xy_px(n, 0), x, kNear);
    EXPECT_NEAR(keypoints.xy_px(n, 1), y, kNear);
    EXPECT_NEAR(keypoints.response(n), 0.8, 1e-5);
    EXPECT_EQ(keypoints.scale_px(n), 1.0);
    EXPECT_EQ(keypoints.angle_rad(n), 0.0);
    EXPECT_NEAR(keypoints.descriptors(n, 0), (x + 0.5) / 4.0 - 0.5, kNear);
    EXPECT_NEAR(keypoints.descriptors(n, 1), (y + 0.5) / 4.0 - 0.5, kNear);
    EXPECT_EQ(keypoints.descriptors(n, 2), -5.0F);
  }
  network.descriptors = "{output: descriptors, metric: l2, normalise: false, align_corners: true}";
  EXPECT_NEAR(found(image).descriptors(2, 0), 131.0 * 39.0 / 159.0, kNear);
}

TEST_F(OnnxMaps, FindsAPairBetweenItsPixels) {
  Image image = black(160, 120);
  image.pixels(60, 50) = image.pixels(60, 51) = 200;
  image.pixels(30, 99) = image.pixels(31, 99) = 200;
  const Keypoints keypoints = found(image);
  ASSERT_EQ(keypoints.count(), 2);
  EXPECT_NEAR(keypoints.xy_px(0, 0), 99.0, kNear);
  EXPECT_NEAR(keypoints.xy_px(0, 1), 30.5, kNear);
  EXPECT_NEAR(keypoints.xy_px(1, 0), 50.5, kNear);
  EXPECT_NEAR(keypoints.xy_px(1, 1), 60.0, kNear);
}

/// A square of the frame that is exactly one pixel of the network's image, in frames of the given
/// sizes; the smaller side ratio determines the scale.
TEST_F(OnnxMaps, MapsPlacesBackToFramesOfOtherSizes) {
  struct Case {
    int width, height, pitch;
  };
  for (const auto& [width, height, pitch] :
       {Case{160, 120, 1}, Case{320, 240, 2}, Case{480, 360, 3}, Case{320, 100, 2},
        Case{130, 240, 2}, Case{640, 480, 4}}) {
    Image image = black(width, height);
    for (int y = 0; y < pitch; ++y) {
      for (int x = 0; x < pitch; ++x) image.pixels(20 * pitch + y, 30 * pitch + x) = 255;
    }
    const Keypoints keypoints = found(image);
    ASSERT_EQ(keypoints.count(), 1) << width << " x " << height;
    EXPECT_NEAR(keypoints.xy_px(0, 0), 30 * pitch + 0.5 * (pitch - 1), kNear);
    EXPECT_NEAR(keypoints.xy_px(0, 1), 20 * pitch + 0.5 * (pitch - 1), kNear);
    EXPECT_NEAR(keypoints.scale_px(0), pitch, 1e-6);
  }
  // A frame that is enlarged twice: the peak is between two pixels of the network's image.
  Image small = black(80, 60);
  small.pixels(25, 31) = 255;
  const Keypoints keypoints = found(small);
  ASSERT_EQ(keypoints.count(), 1);
  constexpr double kNotQuadratic = 0.02;  // px; the scores of an enlarged pixel
  EXPECT_NEAR(keypoints.xy_px(0, 0), 31.0, kNotQuadratic);
  EXPECT_NEAR(keypoints.xy_px(0, 1), 25.0, kNotQuadratic);
  EXPECT_NEAR(keypoints.scale_px(0), 0.5, 1e-6);
}

TEST_F(OnnxMaps, SeesRedBeforeBlue) {
  network.image.channels = 3;
  network.kernel = network.full_kernel();
  std::fill(network.kernel.begin() + 25, network.kernel.end(), 0.0F);
  Image image;
  image.pixels = Array<std::uint8_t>({120, 160, 3}, 0);
  image.pixels(50, 3 * 40) = 255;      // blue
  image.pixels(70, 3 * 40 + 2) = 255;  // red
  const Keypoints keypoints = found(image);
  ASSERT_EQ(keypoints.count(), 1);
  EXPECT_NEAR(keypoints.xy_px(0, 1), 70.0, kNear);
}

TEST_F(OnnxMaps, HasNoKeypointsInAnImageWithoutTexture) {
  PluginUnderTest plugin("detectors/onnx", params(", threshold: -1000"));
  for (const Image& image : {black(160, 120), constant_image(160, 120), black(1, 1)}) {
    const auto out = plugin.process(0, {input("image", image)});
    EXPECT_EQ(out.status, WEFT_DEGENERATE);
    EXPECT_EQ(out.message, "no keypoints");
    EXPECT_EQ(out.get<Keypoints>()->count(), 0);
    EXPECT_EQ(out.get<Keypoints>()->descriptors.dim(1), 3);
  }
}

TEST_F(OnnxMaps, KeepsTheStrongestOfTooMany) {
  Image image = black(160, 120);
  for (int n = 0; n < 100; ++n) {
    image.pixels(10 + 10 * (n / 10), 10 + 14 * (n % 10)) = static_cast<std::uint8_t>(100 + n);
  }
  EXPECT_EQ(found(image).count(), 100);
  const Keypoints some = found(image, ", max_keypoints: 7, buckets: 1");
  ASSERT_EQ(some.count(), 7);
  for (std::int64_t n = 0; n < 7; ++n) {
    EXPECT_NEAR(some.response(n), 0.8 * (193 + static_cast<double>(n)) / 255.0, 1e-5);
  }
  const Keypoints spread = found(image, ", max_keypoints: 25, buckets: 5");
  ASSERT_EQ(spread.count(), 25);
  EXPECT_LT(spread.xy_px(0, 1), 31.0) << "each of 5 x 5 cells has keypoints";
  EXPECT_EQ(found(image, ", threshold: 0.5").count(), 40) << "grey levels from 160 on";
}

TEST_F(OnnxMaps, LooksOnlyInsideTheRegion) {
  Image image = black(160, 120);
  image.pixels(50, 40) = image.pixels(50, 120) = 255;
  Region region;
  region.mask = Array<std::uint8_t>({120, 160}, 0);
  for (int y = 0; y < 120; ++y) region.mask(y, 120) = 1;
  PluginUnderTest plugin("detectors/onnx", params());
  const auto inside = plugin.process(0, {input("image", image), input("region", region)});
  ASSERT_EQ(inside.get<Keypoints>()->count(), 1);
  EXPECT_NEAR(inside.get<Keypoints>()->xy_px(0, 0), 120.0, kNear);
}

TEST_F(OnnxMaps, GivesAMovedImageTheSameDescriptors) {
  constexpr int kSeed = 3, kShift = 8;  // px; a multiple of a cell of the descriptors
  network.dims = 16;
  Rng rng(kSeed);
  std::cout << "seed " << kSeed << "\n";
  for (int i = 0; i < 16 * 16; ++i) network.from_image.push_back(static_cast<float>(rng.normal()));
  network.descriptors = "{output: descriptors, metric: l2, normalise: true}";
  const Image whole = detectors::texture(200, 160, kSeed);
  const auto part = [&](int shift) {
    return found(image_of(160, 120, [&](double x, double y) {
      return whole.pixels(static_cast<int>(y) + 20, static_cast<int>(x) + 20 + shift);
    }));
  };
  const Keypoints still = part(0), moved = part(kShift);
  ASSERT_GT(still.count(), 100);
  int inside = 0, same = 0;
  for (std::int64_t i = 0; i < still.count(); ++i) {
    if (still.xy_px(i, 0) < 8.0 + kShift || still.xy_px(i, 0) > 151.0) continue;
    ++inside;
    for (std::int64_t j = 0; j < moved.count(); ++j) {
      const double dx = still.xy_px(i, 0) - kShift - moved.xy_px(j, 0);
      if (std::hypot(dx, still.xy_px(i, 1) - moved.xy_px(j, 1)) > kNear) continue;
      double product = 0.0;
      for (int d = 0; d < 16; ++d) product += still.descriptors(i, d) * moved.descriptors(j, d);
      same += std::abs(product - 1.0) < 1e-4 ? 1 : 0;
    }
  }
  EXPECT_EQ(same, inside);
  EXPECT_GT(inside, 80);
}

TEST_F(OnnxMaps, GivesTheSameBytesFreshWarmAndInColour) {
  network.describe_places();
  const std::string given = params();
  PluginUnderTest warm("detectors/onnx", given), fresh("detectors/onnx", given);
  const Image image = detectors::texture(200, 160, 5);
  detect(warm, detectors::texture(90, 130, 6));
  Image colour;
  colour.pixels = Array<std::uint8_t>({160, 200, 3}, 0);
  for (std::int64_t i = 0; i < image.pixels.size(); ++i) {
    std::fill_n(colour.pixels.data() + 3 * i, 3, image.pixels.data()[i]);
  }
  const Keypoints a = detect(warm, image), b = detect(fresh, image), c = detect(warm, colour);
  ASSERT_GT(a.count(), 50);
  for (const Keypoints* other : {&b, &c}) {
    ASSERT_EQ(a.count(), other->count());
    for (std::int64_t n = 0; n < a.count(); ++n) {
      EXPECT_EQ(a.xy_px(n, 0), other->xy_px(n, 0));
      EXPECT_EQ(a.response(n), other->response(n));
      EXPECT_EQ(a.descriptors(n, 0), other->descriptors(n, 0));
    }
  }
}

}  // namespace
}  // namespace weft::onnx
