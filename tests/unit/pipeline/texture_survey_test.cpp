// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/texture_survey.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <weft/core/rng.hpp>
#include <weft/testing/synthetic.hpp>

#include "pipeline/survey/texture_view.hpp"

namespace weft::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Keypoints of scale 2 px with descriptors of 128 random numbers.
Keypoints random_keypoints(std::int64_t count, std::uint64_t seed) {
  Rng rng(seed);
  Keypoints points;
  points.metric = "l2";
  points.xy_px = Array<double>({count, 2});
  points.scale_px = Array<double>({count}, 2.0);
  points.descriptors = Array<float>({count, 128});
  for (std::int64_t i = 0; i < count; ++i) {
    points.xy_px(i, 0) = 40.0 * static_cast<double>(i % 20);
    points.xy_px(i, 1) = 40.0 * static_cast<double>(i / 20);
    for (std::int64_t d = 0; d < 128; ++d) {
      points.descriptors(i, d) = static_cast<float>(rng.uniform(0.0, 100.0));
    }
  }
  return points;
}

TEST(LookAlikes, FindsTheTwinOfEachKeypointElsewhere) {
  Keypoints points = random_keypoints(300, 7);
  std::copy_n(points.descriptors.row(3), 128, points.descriptors.row(250));
  std::copy_n(points.descriptors.row(60), 128, points.descriptors.row(61));
  points.xy_px(61, 0) = points.xy_px(60, 0) + 5.0;  // the same place, found twice
  points.xy_px(61, 1) = points.xy_px(60, 1);
  const Correspondences pairs = look_alikes(points, 0.1);
  ASSERT_EQ(pairs.count(), 300);
  for (std::int64_t i = 0; i < pairs.count(); ++i) {
    EXPECT_EQ(pairs.kept(i), i == 3 || i == 250 ? 1 : 0) << i;
    EXPECT_EQ(pairs.template_px(i, 0), points.xy_px(i, 0));
  }
  EXPECT_EQ(pairs.image_px(3, 0), points.xy_px(250, 0));
  EXPECT_EQ(pairs.image_px(3, 1), points.xy_px(250, 1));
  EXPECT_NEAR(pairs.distance(3), 0.0, 3e-3);
  EXPECT_GT(pairs.distance(60), 0.1);
  EXPECT_EQ(look_alikes(Keypoints{}, 0.1).count(), 0);
}

TEST(ViewOfTexture, ShowsAPlaceOfTheTextureWhereItSaysThatItIs) {
  Template sheet = make_template({5, 3, 0.4, 0.2, 800, 400});
  std::fill_n(sheet.texture.data(), sheet.texture.size(), std::uint8_t{200});
  const Eigen::Vector2d dot(530.0, 130.0);
  for (std::int64_t v = 100; v < 160; ++v) {
    for (std::int64_t u = 500; u < 560; ++u) {
      const double off =
          std::hypot(static_cast<double>(u) - dot.x(), static_cast<double>(v) - dot.y());
      if (off < 20.0) sheet.texture(v, u) = 20;
    }
  }
  const TextureView view = view_of_texture(sheet, 400.0, 1);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weights = 0.0;
  for (std::int64_t y = 0; y < view.image.pixels.dim(0); ++y) {
    for (std::int64_t x = 0; x < view.image.pixels.dim(1); ++x) {
      const double dark = std::max(0.0, 100.0 - view.image.pixels(y, x));
      sum += dark * Eigen::Vector2d(static_cast<double>(x), static_cast<double>(y));
      weights += dark;
    }
  }
  EXPECT_LT((sum / weights - view.seen_at(dot)).norm(), 0.1);
  EXPECT_NEAR(view.turn.col(0).norm(), 0.5, 1e-12);
  for (const double u : {-0.5, 799.5}) {
    for (const double v : {-0.5, 399.5}) {
      const Eigen::Vector2d corner = view.seen_at({u, v});
      EXPECT_GT(corner.minCoeff(), 5.0);
      EXPECT_LT(corner.x(), static_cast<double>(view.image.pixels.dim(1)) - 5.0);
      EXPECT_LT(corner.y(), static_cast<double>(view.image.pixels.dim(0)) - 5.0);
    }
  }
}

TEST(WarningsOfATexture, NameWhatIsPoorAndWhatRepeats) {
  TemplateSurvey numbers;
  numbers.mean_edge_mm = 25.0;
  numbers.size_mm = {297.0, 210.0, 0.0};
  TextureSurvey texture;
  texture.view_px = 400.0;
  texture.keypoints = 800;
  texture.expected_matches = 300;
  texture.twin_share = 0.03;
  texture.gap_mm = 45.0;
  EXPECT_THAT(warnings_of(texture, numbers), IsEmpty());
  texture.expected_matches = 20;
  texture.twin_share = 0.9;
  texture.gap_mm = 130.0;
  texture.gap_px = {412.0, 80.0};
  EXPECT_THAT(warnings_of(texture, numbers),
              ElementsAre(HasSubstr("20 matches are to be expected in a view of 400 px"),
                          HasSubstr("90 % of its keypoints have a twin elsewhere"),
                          HasSubstr("within 65 mm of (412, 80) px of the texture")));
}

}  // namespace
}  // namespace weft::testing
