// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>

#include "small_film.hpp"

namespace weft::testing {
namespace {

ObjectMask mask_of(SmallFilm& film, std::uint64_t frame) {
  return film.read(frame).get<ObjectMask>().value_or(ObjectMask{});
}

/// px^2, sum of the foreground's shares.
double area_px2(const ObjectMask& mask) {
  double sum = 0.0;
  for (std::int64_t i = 0; i < mask.foreground.size(); ++i) sum += mask.foreground.data()[i];
  return sum / 255.0;
}

TEST(ExactMask, IsThereOnRequestOnlyAndChangesNothingElse) {
  SmallFilm without("occluder: true"), with("occluder: true, mask: true");
  EXPECT_FALSE(without.read(2).get<ObjectMask>().has_value());
  EXPECT_TRUE(with.read(2).get<ObjectMask>().has_value());
  EXPECT_EQ(with.pixels(2), without.pixels(2));
}

TEST(ExactMask, HasTheAreaAndTheOutlineOfTheFlatSheet) {
  SmallFilm film("mask: true, width_m: 0.2, distance_m: 0.8");
  const ObjectMask mask = mask_of(film, 0);
  ASSERT_EQ(mask.foreground.dim(0), 240);
  ASSERT_EQ(mask.foreground.dim(1), 320);
  const double width_px = 400.0 * 0.2 / 0.8, height_px = width_px * 595.0 / 842.0;
  EXPECT_NEAR(area_px2(mask), width_px * height_px, 0.01 * width_px * height_px);
  // The left border in the middle row.
  const double left_px = film.camera.cx - 0.5 * width_px;
  std::int64_t x = 0;
  while (mask.foreground(120, x) < 128) ++x;
  const double before = mask.foreground(120, x - 1), after = mask.foreground(120, x);
  const double crossing_px =
      static_cast<double>(x - 1) + (127.5 - before) / std::max(after - before, 1.0);
  EXPECT_NEAR(crossing_px, left_px, 0.25);
  EXPECT_EQ(std::count(mask.known.data(), mask.known.data() + mask.known.size(), 1),
            mask.known.size());
}

TEST(ExactMask, KnowsNothingOfTheHandAndItsSurroundings) {
  SmallFilm film("mask: true, hand_share: 0.3, noise_grey: 0");
  const ObjectMask mask = mask_of(film, 4);
  const GroundTruth truth = film.truth(4);
  std::int64_t hidden = 0, shown = 0;
  for (std::int64_t y = 0; y < 240; ++y) {
    for (std::int64_t x = 0; x < 320; ++x) {
      const bool is_sheet = std::isfinite(truth.uv_m.row(y)[2 * x]);
      EXPECT_TRUE(!is_sheet || mask.foreground(y, x) > 0) << x << ", " << y;
      hidden += mask.known(y, x) == 0 ? 1 : 0;
      shown += mask.known(y, x) != 0 && is_sheet ? 1 : 0;
    }
  }
  EXPECT_GT(hidden, shown / 4);
  EXPECT_GT(shown, 2000);
}

TEST(ExactMask, OfAFrameWithoutTheSheetIsBackground) {
  SmallFilm film("mask: true, invisible_frames: [1]");
  EXPECT_EQ(area_px2(mask_of(film, 1)), 0.0);
  EXPECT_GT(area_px2(mask_of(film, 2)), 1000.0);
}

}  // namespace
}  // namespace weft::testing
