// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <Eigen/LU>
#include <algorithm>
#include <iostream>
#include <limits>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>

#include "common/view/tests/printed_scene.hpp"

namespace weft::refine {
namespace {

using ::testing::HasSubstr;
using weft::testing::LabelledMatches;
using weft::testing::MatchSpec;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr int kSeed = 71;
constexpr testing::PoseSpec kBefore{.distance_m = 0.55, .tilt_y_rad = 0.1};
constexpr testing::PoseSpec kNow{
    .distance_m = 0.552, .x_m = 0.003, .tilt_y_rad = 0.12, .roll_rad = 0.02};

/// A surface that the previous shape has at `before_` and that is seen at `now_`.
class Refine : public ::testing::Test {
 protected:
  Refine() { std::cout << "seed " << kSeed << "\n"; }

  LabelledMatches drawn(const MatchSpec& spec) {
    return testing::draw_matches(scene_.templ, scene_.camera, now_, spec, rng_);
  }

  std::vector<testing::Input> inputs(const Image& image, const Correspondences& matches) const {
    return {testing::input("image", image), testing::input("template", scene_.templ),
            testing::input("camera", scene_.camera), testing::input("correspondences", matches)};
  }

  PluginAnswer answer(const Image& image, const Correspondences& matches,
                      const std::optional<Shape>& shape) {
    std::vector<testing::Input> all = inputs(image, matches);
    if (shape) all.push_back(testing::input("shape", *shape));
    return plugin_.process(0, all);
  }

  Correspondences refined(const Image& image, const Correspondences& matches) {
    const PluginAnswer outcome = answer(image, matches, scene_.shape_of(before_));
    EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
    return *outcome.get<Correspondences>();
  }

  static std::vector<double> distances_px(const Correspondences& matches, const Points2& places) {
    std::vector<double> distances;
    for (std::int64_t i = 0; i < matches.count(); ++i) {
      distances.push_back((matches.image_px.matrix<2>().row(i) - places.row(i)).norm());
    }
    return distances;
  }

  static bool has_moved(const Correspondences& after, const Correspondences& before,
                        std::int64_t i) {
    return after.image_px.matrix<2>().row(i) != before.image_px.matrix<2>().row(i);
  }

  view::PrintedScene scene_;
  Rng rng_{kSeed};
  DevelopableSheet before_ = scene_.bent(0.35, kBefore);
  DevelopableSheet now_ = scene_.bent(0.32, kNow);
  PluginUnderTest plugin_{"matchers/refine"};
};

TEST_F(Refine, TakesNoiseOfHalfAPixelDownToLessThanATenth) {
  const LabelledMatches matches = drawn({.count = 400, .noise_px = 0.5});
  const Correspondences after = refined(scene_.image_of(now_, rng_), matches.matches);
  ASSERT_EQ(after.count(), 400);
  EXPECT_GT(median(distances_px(matches.matches, matches.true_px)), 0.5);
  EXPECT_LT(median(distances_px(after, matches.true_px)), 0.1);
  EXPECT_GT(after.diag.value("refined", 0.0), 300.0);
  EXPECT_NEAR(after.diag.value("step_px", 0.0), 0.59, 0.1);  // Rayleigh: sqrt(2 ln 2) sigma
}

TEST_F(Refine, FindsOffsetsOfFractionsOfAPixelOfAllMatchesAlike) {
  now_ = scene_.bent(0.33, {.distance_m = 0.55, .tilt_y_rad = 0.11});
  const Image image = scene_.image_of(now_, rng_);
  const LabelledMatches exact = drawn({.count = 200});
  for (const double off_px : {0.0, 0.1, 0.25, 0.5, 0.75, 1.5}) {
    Correspondences matches = exact.matches;
    matches.image_px = make_array<double>(exact.true_px);
    matches.image_px.matrix<2>().col(0).array() += 0.8 * off_px;
    matches.image_px.matrix<2>().col(1).array() -= 0.6 * off_px;
    const Correspondences after = refined(image, matches);
    EXPECT_LT(median(distances_px(after, exact.true_px)), 0.08) << off_px;
    Eigen::RowVector2d mean_px = Eigen::RowVector2d::Zero();
    std::int64_t moved = 0;
    for (std::int64_t i = 0; i < after.count(); ++i) {
      if (!has_moved(after, matches, i)) continue;
      mean_px += after.image_px.matrix<2>().row(i) - exact.true_px.row(i);
      ++moved;
    }
    ASSERT_GT(moved, 150) << off_px;
    EXPECT_LT(mean_px.norm() / static_cast<double>(moved), 0.03) << off_px;
  }
}

TEST_F(Refine, IsNotPulledByLight) {
  const LabelledMatches matches = drawn({.count = 200, .noise_px = 0.5});
  const Image image = scene_.image_of(now_, rng_);
  for (const double gain : {0.5, 1.4}) {
    const Image lit = view::PrintedScene::unevenly_lit(image, gain);
    const Correspondences after = refined(lit, matches.matches);
    EXPECT_LT(median(distances_px(after, matches.true_px)), 0.1) << gain;
  }
}

TEST_F(Refine, LeavesMatchesUnderAnArmWhereTheyAre) {
  const LabelledMatches matches = drawn({.count = 400, .noise_px = 0.5});
  Image image = scene_.image_of(now_, rng_);
  const auto is_arm = [](double x, double y) { return std::abs(x - 300.0 + y / 4.0) < 35.0; };
  for (std::int64_t y = 0; y < image.pixels.dim(0); ++y) {
    for (std::int64_t x = 0; x < image.pixels.dim(1); ++x) {
      if (!is_arm(static_cast<double>(x), static_cast<double>(y))) continue;
      const double skin = 150.0 + 30.0 * std::sin(0.07 * static_cast<double>(x + 2 * y));
      image.pixels(y, x) = static_cast<std::uint8_t>(std::lround(skin));
    }
  }
  const Correspondences after = refined(image, matches.matches);
  std::int64_t covered = 0, moved = 0;
  for (std::int64_t i = 0; i < after.count(); ++i) {
    if (!is_arm(matches.true_px(i, 0), matches.true_px(i, 1))) continue;
    covered += 1;
    const double off_px = (after.image_px.matrix<2>().row(i) - matches.true_px.row(i)).norm();
    if (!has_moved(after, matches.matches, i)) continue;
    ++moved;
    EXPECT_LT(off_px, 2.0) << i;  // a patch at the arm's edge, half of it visible
  }
  EXPECT_GT(covered, 30);
  EXPECT_LT(10 * moved, 3 * covered) << moved << " of " << covered;
}

TEST_F(Refine, MovesNoMismatchFarAndHardlyAny) {
  const LabelledMatches matches = drawn({.count = 400, .correct_rate = 0.5, .noise_px = 0.5});
  const Correspondences after = refined(scene_.image_of(now_, rng_), matches.matches);
  std::int64_t moved = 0;
  for (std::int64_t i = 0; i < after.count(); ++i) {
    const auto step =
        after.image_px.matrix<2>().row(i) - matches.matches.image_px.matrix<2>().row(i);
    EXPECT_LE(step.norm(), 2.0) << i;  // max_step_px
    if (matches.correct[to_index(i)] == 0 && has_moved(after, matches.matches, i)) ++moved;
  }
  EXPECT_LE(moved, 4);
}

TEST_F(Refine, LeavesRejectedMatchesAndThoseBeyondTheMeshUntouched) {
  LabelledMatches drawn_matches = drawn({.count = 100, .noise_px = 0.5});
  Correspondences& matches = drawn_matches.matches;
  for (std::int64_t i = 0; i < 100; i += 4) matches.kept(i) = 0;
  for (std::int64_t i = 1; i < 100; i += 4) matches.face(i) = -1;
  const Correspondences after = refined(scene_.image_of(now_, rng_), matches);
  std::int64_t moved = 0;
  for (std::int64_t i = 0; i < 100; ++i) {
    EXPECT_EQ(after.kept(i), matches.kept(i));
    EXPECT_EQ(after.face(i), matches.face(i));
    if (i % 4 < 2) {
      EXPECT_FALSE(has_moved(after, matches, i)) << i;
      EXPECT_EQ(after.covariance_px2.row(i)[0], 1.0) << i;  // unrefined_noise_px
      EXPECT_EQ(after.covariance_px2.row(i)[1], 0.0) << i;
    } else if (has_moved(after, matches, i)) {
      ++moved;
    }
  }
  EXPECT_GT(moved, 35);
}

TEST_F(Refine, SaysHowExactAMatchIs) {
  now_ = scene_.bent(0.33, {.distance_m = 0.55, .tilt_y_rad = 0.11});
  const LabelledMatches matches = drawn({.count = 400, .noise_px = 0.5});
  const Correspondences after = refined(scene_.image_of(now_, rng_), matches.matches);
  std::vector<double> squares;  // in units of the reported deviation
  for (std::int64_t i = 0; i < after.count(); ++i) {
    if (!has_moved(after, matches.matches, i)) continue;
    const Eigen::Vector2d off_px = after.image_px.matrix<2>().row(i) - matches.true_px.row(i);
    const Eigen::Map<const Eigen::Matrix2d> covariance(after.covariance_px2.row(i));
    squares.push_back(off_px.dot(covariance.inverse() * off_px));
  }
  // Half of a chi square of two degrees of freedom lies below 1.39. The difference between patch
  // and image is not only noise, so that the place of a patch is somewhat more accurate than
  // reported.
  EXPECT_GT(median(squares), 0.1);
  EXPECT_LT(median(squares), 3.0);
}

TEST_F(Refine, TakesTheShapeOfTheFrameBeforeWhereThereIsNoOther) {
  const LabelledMatches matches = drawn({.count = 200, .noise_px = 0.5});
  std::vector<testing::Input> all = inputs(scene_.image_of(now_, rng_), matches.matches);
  all.push_back(testing::input("previous.shape", scene_.shape_of(before_)));
  const PluginAnswer outcome = plugin_.process(0, all);
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  EXPECT_LT(median(distances_px(*outcome.get<Correspondences>(), matches.true_px)), 0.1);
}

TEST_F(Refine, HandsTheMatchesOnWhereThereIsNoShapeInSight) {
  const Image image = scene_.image_of(now_, rng_);
  const Correspondences matches = drawn({.count = 50, .noise_px = 0.5}).matches;
  std::vector<std::optional<Shape>> shapes{std::nullopt};
  shapes.emplace_back(scene_.shape_of(before_))->state =
      static_cast<std::int32_t>(ShapeState::lost);
  for (const double depth_m : {-0.5, std::numeric_limits<double>::quiet_NaN()}) {
    shapes.emplace_back(scene_.shape_of(before_))
        ->vertices_m.matrix<3>()
        .col(2)
        .setConstant(depth_m);
  }
  shapes.emplace_back(scene_.shape_of(before_))->vertices_m.matrix<3>().col(0).array() += 2.0;
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const PluginAnswer outcome = answer(image, matches, shapes[k]);
    ASSERT_EQ(outcome.status, WEFT_DEGENERATE) << k << ": " << outcome.message;
    EXPECT_THAT(outcome.message, HasSubstr("the matches as they came")) << k;
    const auto after = *outcome.get<Correspondences>();
    ASSERT_EQ(after.count(), matches.count());
    for (std::int64_t i = 0; i < matches.count(); ++i) EXPECT_FALSE(has_moved(after, matches, i));
  }
}

TEST_F(Refine, TakesAnyNumberOfMatchesAlsoOutsideOfTheImage) {
  const Image image = scene_.image_of(now_, rng_);
  const Shape shape = scene_.shape_of(before_);
  EXPECT_EQ(answer(image, drawn({.count = 0}).matches, shape).status, WEFT_NO_RESULT);
  EXPECT_EQ(refined(image, drawn({.count = 3}).matches).count(), 3);
  Correspondences matches = drawn({.count = 4}).matches;
  matches.image_px(3, 0) = -5.0;
  EXPECT_EQ(refined(image, matches).image_px(3, 0), -5.0);
}

TEST_F(Refine, NamesTheMatchThatIsNotFinite) {
  const Image image = scene_.image_of(now_, rng_);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Correspondences matches = drawn({.count = 4}).matches;
    matches.image_px(2, 1) = bad;
    const PluginAnswer outcome = answer(image, matches, scene_.shape_of(before_));
    EXPECT_EQ(outcome.status, WEFT_ERROR);
    EXPECT_THAT(outcome.message, HasSubstr("atch"));
  }
}

TEST_F(Refine, LeavesMatchesOfASheetWithoutTextureWhereTheyAre) {
  const Image image = scene_.image_of(now_, rng_);
  std::fill_n(scene_.templ.texture.data(), scene_.templ.texture.size(), std::uint8_t{128});
  const Correspondences after = refined(image, drawn({.count = 60}).matches);
  EXPECT_EQ(after.diag.value("refined", -1.0), 0.0);
  EXPECT_EQ(after.diag.value("flat", 0.0) + after.diag.value("hidden", 0.0), 60.0);
}

TEST_F(Refine, RefusesWhatDoesNotBelongTogether) {
  const Image image = scene_.image_of(now_, rng_);
  Correspondences matches = drawn({.count = 20}).matches;
  Image small;
  small.pixels = Array<std::uint8_t>({1, 1}, 0);
  const PluginAnswer other_size = answer(small, matches, scene_.shape_of(before_));
  EXPECT_EQ(other_size.status, WEFT_ERROR);
  EXPECT_THAT(other_size.message, HasSubstr("the size of the camera"));
  std::vector<testing::Input> twice = inputs(image, matches);
  twice.push_back(testing::input("correspondences", matches));
  const PluginAnswer two_sets = plugin_.process(0, twice);
  EXPECT_EQ(two_sets.status, WEFT_ERROR);
  EXPECT_THAT(two_sets.message, HasSubstr("matchers/merge"));
  matches.face(7) = static_cast<std::int32_t>(scene_.templ.faces.rows());
  const PluginAnswer no_face = answer(image, matches, scene_.shape_of(before_));
  EXPECT_EQ(no_face.status, WEFT_ERROR);
  EXPECT_THAT(no_face.message, HasSubstr("match 7 lies in face"));
}

}  // namespace
}  // namespace weft::refine
