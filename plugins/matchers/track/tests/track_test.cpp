// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <iostream>
#include <numeric>
#include <weft/data/matrix.hpp>

#include "../motion.hpp"
#include "../tracker.hpp"
#include "common/view/patch.hpp"
#include "common/view/tests/printed_scene.hpp"

namespace weft::track {
namespace {

/// A textured surface for tracking.
struct TrackScene : view::PrintedScene {
  testing::PluginAnswer track(testing::PluginUnderTest& plugin, const Image& image,
                              const Shape& before,
                              const std::optional<Correspondences>& matches = {}) const {
    std::vector<testing::Input> inputs{
        testing::input("image", image), testing::input("template", templ),
        testing::input("camera", camera), testing::input("previous.shape", before)};
    if (matches) inputs.push_back(testing::input("previous.correspondences", *matches));
    return plugin.process(0, inputs);
  }
};

using ::testing::HasSubstr;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr int kSeed = 21;

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

class TrackedSheet : public ::testing::Test {
 protected:
  TrackedSheet() { std::cout << "seed " << kSeed << "\n"; }

  /// The result for a surface that was at `before_` and is now at `now`.
  PluginAnswer follow(const DevelopableSheet& now, const std::string& params = "{}") {
    PluginUnderTest plugin("matchers/track", params);
    return scene_.track(plugin, scene_.image_of(now, rng_), scene_.shape_of(before_));
  }

  TrackScene scene_;
  Rng rng_{kSeed};
  DevelopableSheet before_ = scene_.bent(0.35, {.distance_m = 0.55, .tilt_y_rad = 0.1});
};

TEST_F(TrackedSheet, IsFollowedToAFractionOfAPixel) {
  const DevelopableSheet now =
      scene_.bent(0.32, {.distance_m = 0.552, .x_m = 0.003, .tilt_y_rad = 0.12, .roll_rad = 0.02});
  const PluginAnswer outcome = follow(now);
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  const auto matches = *outcome.get<Correspondences>();
  const std::vector<double> errors = scene_.errors_px(matches, now);
  EXPECT_GT(matches.count(), 180);
  EXPECT_LT(mean(errors), 0.1);
  EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 0.6);
  EXPECT_EQ(matches.diag.value("refilled", 0.0), static_cast<double>(matches.count()));
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    const Eigen::Matrix2d jacobian =
        scene_.jacobian_at(matches.template_px.matrix<2>().row(i), before_);
    EXPECT_NEAR(matches.scale_ratio(i), std::sqrt(jacobian.determinant()), 0.02);
    EXPECT_NEAR(matches.angle_difference_rad(i),
                std::atan2(jacobian(1, 0) - jacobian(0, 1), jacobian.trace()), 0.03);
  }
}

TEST_F(TrackedSheet, IsFoundFortyPixelsAway) {
  const DevelopableSheet now =
      scene_.bent(0.35, {.distance_m = 0.55, .x_m = 0.022, .y_m = -0.015, .tilt_y_rad = 0.1});
  const PluginAnswer outcome = follow(now);
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  EXPECT_LT(mean(scene_.errors_px(*outcome.get<Correspondences>(), now)), 0.1);
  EXPECT_NE(follow(now, "{search_px: 8}").status, WEFT_OK);
}

TEST_F(TrackedSheet, IsFollowedThroughATurnAndABendAtOnce) {
  const DevelopableSheet now = scene_.bent(
      0.25,
      {.distance_m = 0.53, .x_m = 0.01, .tilt_x_rad = 0.08, .tilt_y_rad = 0.2, .roll_rad = 0.08});
  const PluginAnswer outcome = follow(now);
  // Parts that become visible are missed by this much a turn.
  ASSERT_EQ(outcome.status, WEFT_DEGENERATE);
  EXPECT_THAT(outcome.message, HasSubstr("weak: the surface turned, grew or sheared by "));
  const auto errors = scene_.errors_px(*outcome.get<Correspondences>(), now);
  EXPECT_GT(errors.size(), 120U);
  EXPECT_LT(mean(errors), 0.2);
}

TEST_F(TrackedSheet, DoesNotMindBrightnessAndContrast) {
  const DevelopableSheet now = scene_.bent(0.33, {.distance_m = 0.55, .x_m = 0.004});
  Image image = scene_.image_of(now, rng_);
  for (std::int64_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels.data()[i] = static_cast<std::uint8_t>(60.0 + 0.5 * image.pixels.data()[i]);
  }
  PluginUnderTest plugin("matchers/track");
  const PluginAnswer outcome = scene_.track(plugin, image, scene_.shape_of(before_));
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  EXPECT_LT(mean(scene_.errors_px(*outcome.get<Correspondences>(), now)), 0.12);
}

TEST_F(TrackedSheet, IsNotSeenThroughWhatCoversIt) {
  const DevelopableSheet now = scene_.bent(0.35, {.distance_m = 0.55, .x_m = 0.003});
  for (const std::int64_t covered_px : {120, 330}) {
    Image image = scene_.image_of(now, rng_);
    const std::int64_t first = 110, last = first + covered_px;
    for (std::int64_t y = 0; y < image.pixels.dim(0); ++y) {
      for (std::int64_t x = first; x < last; ++x) {
        image.pixels(y, x) = static_cast<std::uint8_t>(rng_.uniform(60.0, 200.0));
      }
    }
    PluginUnderTest plugin("matchers/track");
    const PluginAnswer outcome = scene_.track(plugin, image, scene_.shape_of(before_));
    const auto matches = outcome.get<Correspondences>();
    ASSERT_TRUE(matches) << outcome.message;
    for (std::int64_t i = 0; i < matches->count(); ++i) {
      const double x = matches->image_px(i, 0);
      EXPECT_TRUE(x < static_cast<double>(first) + 4.0 || x > static_cast<double>(last) - 4.0) << x;
    }
    EXPECT_LT(mean(scene_.errors_px(*matches, now)), 0.12);
    const bool is_much = covered_px > 200;
    EXPECT_EQ(outcome.status, is_much ? WEFT_DEGENERATE : WEFT_OK) << outcome.message;
    EXPECT_EQ(outcome.message.starts_with("weak: "), is_much);
  }
}

TEST_F(TrackedSheet, IsNotFoundWhereItIsNot) {
  PluginUnderTest plugin("matchers/track");
  Image empty;
  empty.pixels = Array<std::uint8_t>({480, 640}, 0);
  for (std::int64_t i = 0; i < empty.pixels.size(); ++i) {
    empty.pixels.data()[i] = static_cast<std::uint8_t>(rng_.uniform(0.0, 255.0));
  }
  EXPECT_EQ(scene_.track(plugin, empty, scene_.shape_of(before_)).status, WEFT_NO_RESULT);
  const DevelopableSheet elsewhere =
      scene_.bent(-0.4, {.distance_m = 0.7, .x_m = -0.08, .tilt_x_rad = 0.4, .roll_rad = 0.7});
  EXPECT_NE(follow(elsewhere).status, WEFT_OK);
  const DevelopableSheet from_behind = scene_.bent(0.35, {.distance_m = 0.55, .tilt_y_rad = 3.1});
  EXPECT_EQ(
      scene_.track(plugin, scene_.image_of(before_, rng_), scene_.shape_of(from_behind)).status,
      WEFT_NO_RESULT);
}

TEST_F(TrackedSheet, IsDoubtedWhereThePreviousShapeWasDoubtful) {
  PluginUnderTest plugin("matchers/track");
  const Image image = scene_.image_of(before_, rng_);
  Shape shape = scene_.shape_of(before_);
  EXPECT_EQ(scene_.track(plugin, image, shape).status, WEFT_OK);
  shape.confidence = 0.2;
  EXPECT_THAT(scene_.track(plugin, image, shape).message, HasSubstr("a confidence of 20 %"));
  shape.state = static_cast<std::int32_t>(ShapeState::weak);
  const PluginAnswer weak = scene_.track(plugin, image, shape);
  EXPECT_EQ(weak.status, WEFT_DEGENERATE);
  EXPECT_THAT(weak.message, HasSubstr("the previous shape is weak"));
  shape.state = static_cast<std::int32_t>(ShapeState::lost);
  EXPECT_EQ(scene_.track(plugin, image, shape).status, WEFT_NO_RESULT);
}

TEST_F(TrackedSheet, KeepsThePointsOfItsMatchesAndRefillsTheRest) {
  PluginUnderTest plugin("matchers/track");
  const Image image = scene_.image_of(before_, rng_);
  const PluginAnswer first = scene_.track(plugin, image, scene_.shape_of(before_));
  Correspondences matches = *first.get<Correspondences>();
  const std::int64_t all = matches.count();
  for (std::int64_t i = 0; i < all; i += 4) matches.kept(i) = 0;  // as a filter would
  const PluginAnswer second = scene_.track(plugin, image, scene_.shape_of(before_), matches);
  ASSERT_EQ(second.status, WEFT_OK) << second.message;
  const auto again = *second.get<Correspondences>();
  EXPECT_EQ(again.diag.value("followed", 0.0), static_cast<double>(all - (all + 3) / 4));
  EXPECT_EQ(again.count(), all) << "a rejected point is tried again";
}

TEST_F(TrackedSheet, IsAnsweredTheSameWithColours) {
  PluginUnderTest plugin("matchers/track");
  const Image grey = scene_.image_of(before_, rng_);
  Image coloured;
  coloured.pixels = Array<std::uint8_t>({480, 640, 3}, 0);
  for (std::int64_t i = 0; i < coloured.pixels.size(); ++i) {
    coloured.pixels.data()[i] = grey.pixels.data()[i / 3];
  }
  const auto a = *scene_.track(plugin, grey, scene_.shape_of(before_)).get<Correspondences>();
  const auto b = *scene_.track(plugin, coloured, scene_.shape_of(before_)).get<Correspondences>();
  ASSERT_EQ(a.count(), b.count());
  EXPECT_LT((a.image_px.matrix<2>() - b.image_px.matrix<2>()).cwiseAbs().maxCoeff(), 1e-3);
}

/// A smooth image, displaced.
view::ViewLevel waves(double dx, double dy) {
  view::ViewLevel level;
  level.grey.resize(64, 48);
  level.drawn.assign(level.grey.values.size(), 1);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      const double u = x - dx, v = y - dy;
      level.grey.row(y)[x] = static_cast<float>(120.0 + 50.0 * std::sin(0.45 * u + 0.1 * v) +
                                                40.0 * std::cos(0.38 * v - 0.15 * u));
    }
  }
  return level;
}

TEST_F(TrackedSheet, IsTheSameToTheBitOnAnyNumberOfThreads) {
  const DevelopableSheet now =
      scene_.bent(0.32, {.distance_m = 0.56, .x_m = 0.01, .roll_rad = 0.03});
  view::PredictedView view(kFinestDrawn);
  view.load(scene_.templ);
  const Shape before = scene_.shape_of(before_);
  ASSERT_TRUE(view.draw(scene_.camera, before.vertices_m.matrix<3>()));
  view::Pyramid image;
  image.load(scene_.image_of(now, rng_).pixels);
  TexturePoints points;
  ASSERT_TRUE(points.load(scene_.templ, scene_.camera, 300));
  std::vector<Target> targets;
  for (int cell = 0; cell < points.cells(); ++cell) {
    if (points.point(cell).face >= 0) targets.push_back({points.point(cell)});
  }
  Tracker tracker;
  const auto found_by = [&](int threads) {
    std::vector<Target> found = targets;
    tracker.find(view, image, {}, threads, found);
    return found;
  };
  const std::vector<Target> alone = found_by(1);
  EXPECT_GT(std::count_if(alone.begin(), alone.end(),
                          [](const Target& target) { return target.fate == Fate::found; }),
            180);
  for (const int threads : {2, 4, 1, 3}) {
    const std::vector<Target> found = found_by(threads);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      ASSERT_EQ(found[i].fate, alone[i].fate) << i << ", " << threads << " threads";
      ASSERT_EQ(found[i].by_px, alone[i].by_px) << i << ", " << threads << " threads";
      ASSERT_EQ(found[i].correlation, alone[i].correlation) << i << ", " << threads << " threads";
    }
  }
}

TEST(TrackedPatch, FindsADisplacementBelowAPixel) {
  view::Patch patch;
  ASSERT_EQ(patch.take(waves(0.0, 0.0), 26, 18), view::Patch::Fit::usable);
  const view::Alignment found = patch.find_in(waves(1.3, -0.7).grey, 0.0F, 0.0F, 5.0F);
  EXPECT_EQ(found.end, view::Alignment::End::converged);
  EXPECT_NEAR(found.dx, 1.3, 0.03);
  EXPECT_NEAR(found.dy, -0.7, 0.03);
  EXPECT_GT(found.correlation, 0.99F);
}

TEST(TrackedPatch, SaysWhyItCannotBeUsedOrFound) {
  view::Patch patch;
  view::ViewLevel view = waves(0.0, 0.0);
  EXPECT_EQ(patch.take(view, 0, 18), view::Patch::Fit::not_drawn)
      << "its border is beyond the view";
  view.drawn[20 * 64 + 30] = 0;
  EXPECT_EQ(patch.take(view, 26, 18), view::Patch::Fit::not_drawn);
  view::ViewLevel edge = waves(0.0, 0.0);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) edge.grey.row(y)[x] = x < 32 ? 40.0F : 200.0F;
  }
  EXPECT_EQ(patch.take(edge, 26, 18), view::Patch::Fit::flat) << "it may slide along the edge";
  ASSERT_EQ(patch.take(waves(0.0, 0.0), 26, 18), view::Patch::Fit::usable);
  EXPECT_EQ(patch.find_in(waves(0.0, 0.0).grey, 40.0F, 0.0F, 5.0F).end,
            view::Alignment::End::left_image);
  view::Picture empty;
  empty.resize(64, 48);
  EXPECT_EQ(patch.find_in(empty, 0.0F, 0.0F, 5.0F).end, view::Alignment::End::no_contrast);
}

TEST(TrackedMotion, IsAffineThroughMostPointsWhateverTheOthersSay) {
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  const auto truth = [](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(5.0 + 0.02 * p.x() - 0.01 * p.y(), -3.0 + 0.03 * p.y());
  };
  std::vector<Moved> points;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector2d place(rng.uniform(0.0, 600.0), rng.uniform(0.0, 400.0));
    const bool is_wrong = i % 4 == 0;
    points.push_back(
        {place, is_wrong ? Eigen::Vector2d(rng.uniform(-60.0, 60.0), 30.0) : truth(place)});
  }
  std::vector<double> scratch;
  const Motion motion = Motion::fit(points, 1.0, scratch);
  const Eigen::Vector2d place(300.0, 100.0);
  EXPECT_LT((motion.at(place) - truth(place)).norm(), 0.2);
  points.resize(3);
  points[0].by_px = points[1].by_px = points[2].by_px = Eigen::Vector2d(1.0, 2.0);
  EXPECT_EQ(Motion::fit(points, 1.0, scratch).at(place), Eigen::Vector2d(1.0, 2.0));
}

}  // namespace
}  // namespace weft::track
