// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <iostream>
#include <string>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/data/visibility.hpp>

#include "frame.hpp"

namespace weft::collins_integrated {
namespace {

using ::testing::HasSubstr;
using testing::PluginAnswer;
using testing::PluginUnderTest;

TEST(CollinsIntegrated, GivesBackPlanesAndCylindersWithAndWithoutTheirTexture) {
  PluginUnderTest plugin(kId);
  for (const double radius_m : {1e3, 0.3, -0.3, 0.15}) {
    Frame frame(radius_m);
    for (const double noise_px : {0.0, 0.5, 1.0}) {
      const Correspondences matches = frame.matches({200, 1.0, noise_px});
      const PluginAnswer out = frame.solve(plugin, frame.image, &matches, &frame.previous);
      EXPECT_EQ(out.status, WEFT_OK) << out.message;
      const Shape shape = given(out), anew = given(frame.solve(plugin, frame.image, &matches)),
                  plain = given(frame.solve(plugin, frame.blank(), &matches, &frame.previous));
      const double error_mm = frame.mean_error_mm(shape, frame.now);
      std::cout << "radius " << radius_m << " m, noise " << noise_px << " px: " << error_mm
                << " mm, without a past " << frame.mean_error_mm(anew, frame.now)
                << " mm, without texture " << frame.mean_error_mm(plain, frame.now)
                << " mm, median ZNCC " << shape.diag.value("median_zncc", 0.0) << ", strain "
                << shape.diag.value("strain", 0.0) << ", confidence " << shape.confidence << "\n";
      EXPECT_EQ(shape.shape_state(), ShapeState::estimated);
      EXPECT_EQ(plain.shape_state(), ShapeState::weak);
      EXPECT_LT(error_mm, 0.8);
      EXPECT_LT(frame.mean_error_mm(anew, frame.now), 0.8);
      EXPECT_LT(frame.mean_error_mm(plain, frame.now), 3.5);
    }
  }
}

TEST(CollinsIntegrated, TheTextureTakesOutTheNoiseOfFewMatches) {
  PluginUnderTest plugin(kId);
  Frame frame(0.25);
  const Correspondences matches = frame.matches({40, 1.0, 1.5});
  const double with_mm = frame.mean_error_mm(
      given(frame.solve(plugin, frame.image, &matches, &frame.previous)), frame.now);
  const double without_mm = frame.mean_error_mm(
      given(frame.solve(plugin, frame.blank(), &matches, &frame.previous)), frame.now);
  std::cout << "with texture " << with_mm << " mm, without " << without_mm << " mm\n";
  EXPECT_LT(with_mm, 0.5 * without_mm);
}

TEST(CollinsIntegrated, FollowsByTheTextureAlone) {
  Frame frame(0.3, 0.004);
  PluginUnderTest plugin(kId);
  const PluginAnswer out = frame.solve(plugin, frame.image, nullptr, &frame.previous);
  EXPECT_EQ(out.status, WEFT_OK) << out.message;
  std::cout << frame.mean_error_mm(given(out), frame.now) << " mm from "
            << frame.mean_error_mm(frame.previous, frame.now) << " mm\n";
  EXPECT_LT(frame.mean_error_mm(given(out), frame.now), 0.8);
  EXPECT_EQ(given(out).shape_state(), ShapeState::estimated);
  // Where matches are wired, their absence is reported.
  const Correspondences few = frame.matches({3, 1.0, 0.0});
  const PluginAnswer doubted = frame.solve(plugin, frame.image, &few, &frame.previous);
  EXPECT_EQ(doubted.status, WEFT_DEGENERATE);
  EXPECT_EQ(doubted.message, "weak: by the texture alone, there are 3 matches on the mesh");
  EXPECT_LT(frame.mean_error_mm(given(doubted), frame.now), 0.8);
}

TEST(CollinsIntegrated, FollowsASheetThatMovesFivePixelsAFrame) {
  const Frame scene;
  Rng rng(kSeed);
  PluginUnderTest plugin(kId);
  Shape previous;
  double worst_mm = 0.0, mean_mm = 0.0;
  constexpr int kFrames = 16;
  for (int f = 0; f < kFrames; ++f) {
    const double turn = 0.15 * f;
    testing::PoseSpec pose = scene.pose;
    pose.x_m = 0.025 * std::sin(turn);
    pose.y_m = 0.015 * std::cos(turn);
    pose.tilt_y_rad = 0.25 + 0.2 * std::sin(turn);
    const DevelopableSheet now = scene.bent(0.3 - 0.1 * std::sin(turn), pose);
    if (f == 0) previous = scene.shape_of(now);
    const PluginAnswer out = scene.solve(plugin, scene.image_of(now, rng), nullptr, &previous);
    ASSERT_EQ(out.status, WEFT_OK) << f << " " << out.message;
    previous = given(out);
    const double error_mm = scene.mean_error_mm(previous, now);
    worst_mm = std::max(worst_mm, error_mm);
    mean_mm += error_mm / kFrames;
  }
  std::cout << "mean " << mean_mm << " mm, worst " << worst_mm << " mm\n";
  EXPECT_LT(worst_mm, 1.0);
}

TEST(CollinsIntegrated, ASheetThatStaysDoesNotDrift) {
  Frame frame(0.3, 0.0);
  PluginUnderTest plugin(kId);
  Shape previous = frame.previous, early;
  constexpr int kFrames = 40;
  for (int f = 0; f < kFrames; ++f) {
    previous = given(frame.solve(plugin, frame.image, nullptr, &previous));
    if (f == kFrames / 2) early = previous;
  }
  const Points3 drift_m = previous.vertices_m.matrix<3>() - early.vertices_m.matrix<3>();
  const double drift_mm = 1e3 * drift_m.rowwise().norm().mean();
  std::cout << "drift over 20 frames " << drift_mm << " mm, error "
            << frame.mean_error_mm(previous, frame.now) << " mm\n";
  EXPECT_LT(drift_mm, 0.04);
  EXPECT_LT(frame.mean_error_mm(previous, frame.now), 0.8);
}

TEST(CollinsIntegrated, AfterAJumpItIsLostWithoutMatchesAndFoundAnewWithThem) {
  Frame frame(0.3, 0.08);  // 120 px
  PluginUnderTest plugin(kId);
  const PluginAnswer alone = frame.solve(plugin, frame.image, nullptr, &frame.previous);
  EXPECT_EQ(alone.status, WEFT_NO_RESULT);
  EXPECT_THAT(alone.message, HasSubstr("lost: "));
  const Correspondences matches = frame.matches({200, 1.0, 0.5});
  const PluginAnswer out = frame.solve(plugin, frame.image, &matches, &frame.previous);
  EXPECT_EQ(out.status, WEFT_OK) << out.message;
  EXPECT_LT(frame.mean_error_mm(given(out), frame.now), 0.8);
}

TEST(CollinsIntegrated, HalfOfTheMatchesMayBeWrong) {
  Frame frame;
  PluginUnderTest plugin(kId);
  const Correspondences matches = frame.matches({400, 0.5, 0.5});
  for (const Shape* previous :
       {static_cast<const Shape*>(nullptr), static_cast<const Shape*>(&frame.previous)}) {
    const double error_mm =
        frame.mean_error_mm(given(frame.solve(plugin, frame.image, &matches, previous)), frame.now);
    std::cout << (previous == nullptr ? "without" : "with") << " a past " << error_mm << " mm\n";
    EXPECT_LT(error_mm, 0.8);
  }
}

TEST(CollinsIntegrated, WhatIsHiddenIsNotLookedAt) {
  Frame frame(0.3, 0.002);
  // A hand lies over the left quarter.
  Image covered = frame.image;
  for (std::int64_t y = 0; y < 480; ++y) {
    for (std::int64_t x = 0; x < 200; ++x) {
      covered.pixels(y, x) = static_cast<std::uint8_t>(frame.rng.uniform(60.0, 200.0));
    }
  }
  Visibility visibility;
  const std::int64_t count = frame.templ.vertices_m.rows();
  visibility.visible = Array<std::uint8_t>({count}, 1);
  visibility.score = Array<double>({count}, 1.0);
  visibility.reason = Array<std::uint8_t>({count}, 0);
  const Points3 truth_m = testing::bent_vertices(frame.templ, frame.now);
  for (std::int64_t v = 0; v < count; ++v) {
    if (project(testing::pinhole(frame.camera), truth_m.row(v)).x() > 200.0) continue;
    visibility.visible(v) = 0;
    visibility.reason(v) = static_cast<std::uint8_t>(SightReason::hidden);
  }
  PluginUnderTest plugin(kId);
  const auto inputs = [&](bool with_visibility) {
    std::vector<testing::Input> all{
        testing::input("template", frame.templ), testing::input("camera", frame.camera),
        testing::input("image", covered), testing::input("previous.shape", frame.previous)};
    if (with_visibility) all.push_back(testing::input("visibility", visibility));
    return all;
  };
  const Shape with_visibility = given(plugin.process(0, inputs(true)));
  const Shape without_visibility = given(plugin.process(0, inputs(false)));
  EXPECT_GT(without_visibility.diag.value("samples_in_sight", 0.0),
            with_visibility.diag.value("samples_in_sight", 0.0) + 50.0);
  EXPECT_GT(with_visibility.diag.value("median_zncc", 0.0),
            without_visibility.diag.value("median_zncc", 0.0));
  std::cout << "error " << frame.mean_error_mm(with_visibility, frame.now) << " mm\n";
  EXPECT_LT(frame.mean_error_mm(with_visibility, frame.now), 2.0);
  EXPECT_EQ(with_visibility.source(0), 0);
  EXPECT_EQ(with_visibility.source(count - 1), 1);
}

TEST(CollinsIntegrated, SaysTheSameTwiceToTheBit) {
  Frame frame;
  const Correspondences matches = frame.matches({200, 0.9, 0.5});
  PluginUnderTest first(kId), second(kId);
  given(second.process(
      0, {testing::input("template", frame.templ), testing::input("camera", frame.camera),
          testing::input("image", frame.image), testing::input("previous.shape", frame.previous)}));
  for (const Shape* previous :
       {static_cast<const Shape*>(nullptr), static_cast<const Shape*>(&frame.previous)}) {
    const Shape one = given(frame.solve(first, frame.image, &matches, previous));
    const Shape two = given(frame.solve(second, frame.image, &matches, previous));
    EXPECT_EQ(one.vertices_m.matrix<3>(), two.vertices_m.matrix<3>());
    EXPECT_EQ(one.confidence, two.confidence);
  }
}

}  // namespace
}  // namespace weft::collins_integrated
