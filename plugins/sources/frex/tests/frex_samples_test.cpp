// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/face_locator.hpp>

#include "samples/random_sheet.hpp"
#include "small_film.hpp"

namespace weft::testing {
namespace {

using ::testing::HasSubstr;

std::string sample_params(const std::string& more) {
  return std::string("{object: {use: templates/rectangular, params: {texture: ") + WEFT_TEXTURES +
         "sheet_texture.png, width_m: 0.297, columns: 24, rows: 17}}, image_width_px: 160, "
         "image_height_px: 120, focal_px: 205" +
         (more.empty() ? "" : ", ") + more + "}";
}

class Samples : public OpenFilm {
 public:
  explicit Samples(const std::string& more = "", std::uint64_t run_seed = 1)
      : OpenFilm("sources/frex_samples", sample_params(more), run_seed) {}
};

std::int64_t seen_pixels(const GroundTruth& truth) {
  std::int64_t seen = 0;
  for (std::int64_t k = 0; k < truth.uv_m.size(); k += 2) {
    seen += std::isfinite(truth.uv_m.data()[k]) ? 1 : 0;
  }
  return seen;
}

std::string sample_refusal(const std::string& more) {
  PluginUnderTest source("sources/frex_samples", sample_params(more), 1);
  return source.process(kOpen, {}).message;
}

TEST(FrexSamples, AreTheSameInAnyOrder) {
  Samples one, other;
  const auto fifth = one.pixels(5);
  other.pixels(2);
  EXPECT_NE(other.pixels(4), fifth);
  EXPECT_EQ(other.pixels(5), fifth);
  EXPECT_NE(Samples("seed: 2").pixels(5), fifth);
  EXPECT_EQ(Samples("", 9).pixels(5), fifth) << "the seed of the run does not matter";
}

/// The template point of a pixel and its depth must lead back to the pixel: the map of template
/// points is the linear one of the true faces.
TEST(FrexSamples, HaveATruthThatProjectsToItsPixels) {
  Samples samples("empty_share: 0, occluders: 0");
  const Pinhole pinhole = samples.pinhole();
  std::int64_t checked = 0;
  for (std::uint64_t frame = 0; frame < 8; ++frame) {
    const GroundTruth truth = samples.truth(frame);
    const auto xy_m = truth.template_xy_m.matrix<2>();
    const auto points_m = truth.points_m.matrix<3>();
    const auto locator = FaceLocator::create(xy_m, truth.faces.matrix<3>());
    ASSERT_TRUE(locator);
    for (std::int64_t y = 3; y < 120; y += 7) {
      for (std::int64_t x = 3; x < 160; x += 7) {
        const Eigen::Vector2d uv_m(truth.uv_m.row(y)[2 * x], truth.uv_m.row(y)[2 * x + 1]);
        if (!uv_m.allFinite()) continue;
        const FaceLocation at = locator->locate(uv_m);
        ASSERT_GE(at.face, 0);
        Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
        for (int k = 0; k < 3; ++k) {
          point_m += at.weights[k] * points_m.row(truth.faces(at.face, k)).transpose();
        }
        EXPECT_NEAR(point_m.z(), truth.depth_m(y, x), 1e-5);
        EXPECT_NEAR((project(pinhole, point_m) -
                     Eigen::Vector2d(static_cast<double>(x), static_cast<double>(y)))
                        .norm(),
                    0.0, 0.02);
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 300);
}

TEST(FrexSamples, ShowTheObjectInTheShareThatIsAsked) {
  Samples all("empty_share: 0, occluders: 0"), none("empty_share: 1"), half("empty_share: 0.5");
  int with = 0;
  for (std::uint64_t frame = 0; frame < 40; ++frame) {
    EXPECT_GT(seen_pixels(all.truth(frame)), 0) << frame;
    const GroundTruth empty = none.truth(frame);
    EXPECT_EQ(seen_pixels(empty), 0);
    for (std::int64_t v = 0; v < empty.count(); ++v) ASSERT_EQ(empty.visible(v), 0);
    with += seen_pixels(half.truth(frame)) > 0 ? 1 : 0;
  }
  EXPECT_GT(with, 8);
  EXPECT_LT(with, 32);
}

/// The same seed draws the same objects; things before them only take pixels away.
TEST(FrexSamples, LoseTheLabelsUnderOccluders) {
  Samples open("empty_share: 0, occluders: 0"), covered("empty_share: 0, occluders: 12");
  std::int64_t before = 0, after = 0;
  for (std::uint64_t frame = 0; frame < 12; ++frame) {
    const GroundTruth full = open.truth(frame), part = covered.truth(frame);
    ASSERT_EQ(full.points_m.matrix<3>(), part.points_m.matrix<3>());
    before += seen_pixels(full);
    after += seen_pixels(part);
    for (std::int64_t k = 0; k < full.depth_m.size(); ++k) {
      const bool is_seen = std::isfinite(part.uv_m.data()[2 * k]);
      ASSERT_TRUE(!is_seen || part.depth_m.data()[k] > 0.0F);
      ASSERT_TRUE(!is_seen || std::isfinite(full.uv_m.data()[2 * k]));
    }
    for (std::int64_t v = 0; v < full.count(); ++v) ASSERT_LE(part.visible(v), full.visible(v));
  }
  EXPECT_LT(after, before * 9 / 10);
  EXPECT_GT(after, before / 10);
}

TEST(FrexSamples, AreRefusedWithPlaceAndFix) {
  EXPECT_THAT(sample_refusal("nearest: 3, farthest: 2"),
              HasSubstr("'nearest' is larger than 'farthest'"));
  EXPECT_THAT(sample_refusal(std::string("backgrounds: ") + WEFT_TEXTURES + "../ablations"),
              HasSubstr("holds no image"));
}

TEST(FrexSamples, RefuseAnObjectThatIsNotFlat) {
  PluginUnderTest source("sources/frex_samples",
                         std::string("{object: {use: templates/mesh, params: {mesh: ") +
                             WEFT_TEXTURES + "label.obj, texture: " + WEFT_TEXTURES +
                             "sheet_texture.png, unit_m: 0.001}}}",
                         1);
  EXPECT_THAT(source.process(kOpen, {}).message, HasSubstr("not flat at rest"));
}

/// Distances of 0.5 mm stay as they are: cylinders and cones keep lengths.
TEST(RandomSheets, KeepAllLengths) {
  constexpr double kStep_m = 5e-4;
  Points2 flat_m(3 * 20 * 14, 2);
  for (Eigen::Index k = 0; k < 280; ++k) {
    const Eigen::RowVector2d at_m(0.015 * static_cast<double>(k % 20),
                                  0.015 * static_cast<double>(k / 20));
    flat_m.row(3 * k) = at_m;
    flat_m.row(3 * k + 1) = at_m + Eigen::RowVector2d(kStep_m, 0.0);
    flat_m.row(3 * k + 2) = at_m + Eigen::RowVector2d(0.0, kStep_m);
  }
  const Camera camera{410.0, 410.0, 159.5, 119.5, 320, 240};
  const frex::RandomSheet sheet({}, flat_m, camera);
  constexpr std::uint64_t kSeed = 4;
  Rng rng(kSeed);
  for (int draw = 0; draw < 60; ++draw) {
    const Points3 bent_m = sheet.draw(rng);
    ASSERT_TRUE(bent_m.allFinite());
    EXPECT_GT(bent_m.col(2).minCoeff(), 0.0);
    for (Eigen::Index k = 0; k < 280; ++k) {
      for (int other = 1; other <= 2; ++other) {
        EXPECT_NEAR((bent_m.row(3 * k + other) - bent_m.row(3 * k)).norm(), kStep_m, 2e-3 * kStep_m)
            << "draw " << draw << ", seed " << kSeed;
      }
    }
  }
}

}  // namespace
}  // namespace weft::testing
