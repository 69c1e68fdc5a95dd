// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <iostream>
#include <limits>
#include <string>
#include <weft/data/matrix.hpp>

#include "frame.hpp"

namespace weft::collins_integrated {
namespace {

using ::testing::HasSubstr;
using testing::PluginAnswer;
using testing::PluginUnderTest;

TEST(CollinsIntegratedWithBadInput, TooFewMatchesWithoutAPastAreALoss) {
  Frame frame;
  PluginUnderTest plugin(kId);
  EXPECT_EQ(frame.solve(plugin, frame.image, nullptr).status, WEFT_NO_RESULT);
  const Shape lost = frame.shape_of(frame.now, ShapeState::lost);
  for (const int count : {0, 1, 3, 14}) {
    const Correspondences matches = frame.matches({count, 1.0, 0.0});
    const PluginAnswer out = frame.solve(plugin, frame.image, &matches, &lost);
    EXPECT_EQ(out.status, WEFT_NO_RESULT) << count;
    EXPECT_EQ(out.message, "lost: " + std::to_string(count) +
                               " matches on the mesh of at least 15, and no previous shape to "
                               "follow");
  }
  Correspondences line = frame.matches({60, 1.0, 0.0}), heap = frame.matches({60, 1.0, 0.0});
  for (std::int64_t i = 0; i < 60; ++i) {
    line.image_px(i, 1) = 100.0 + 0.5 * line.image_px(i, 0);
    heap.image_px(i, 0) = heap.image_px(i, 1) = 200.0;
  }
  for (const Correspondences& matches : {line, heap}) {
    const PluginAnswer out = frame.solve(plugin, frame.image, &matches);
    EXPECT_EQ(out.status, WEFT_NO_RESULT);
    EXPECT_THAT(out.message, HasSubstr("on a line of the image or in one place"));
  }
}

TEST(CollinsIntegratedWithBadInput, AnotherPrintIsNeverAnEstimatedShape) {
  Frame frame;
  PluginUnderTest plugin(kId);
  const Correspondences matches = frame.matches({200, 1.0, 0.5});
  PrintedScene other;
  other.templ = other.printed(6);
  EXPECT_EQ(other.solve(plugin, frame.image, nullptr, &frame.previous).status, WEFT_NO_RESULT);
  const PluginAnswer out = other.solve(plugin, frame.image, &matches, &frame.previous);
  EXPECT_EQ(out.status, WEFT_DEGENERATE);
  EXPECT_THAT(out.message, HasSubstr("weak: by the matches alone"));
  EXPECT_EQ(given(out).shape_state(), ShapeState::weak);
}

TEST(CollinsIntegratedWithBadInput, FromAMirroredPastTheShapeIsRightOrWeak) {
  Frame frame;
  PluginUnderTest plugin(kId);
  for (const double radius_m : {-0.3, -0.2, -0.15}) {
    const Shape mirrored = frame.shape_of(frame.bent(radius_m, frame.pose));
    const PluginAnswer out = frame.solve(plugin, frame.image, nullptr, &mirrored);
    const auto shape = out.get<Shape>();
    std::cout << radius_m << " m: "
              << (shape ? std::to_string(frame.mean_error_mm(*shape, frame.now)) +
                              " mm, confidence " + std::to_string(shape->confidence)
                        : out.message)
              << "\n";
    const bool is_sure = shape && shape->shape_state() == ShapeState::estimated;
    EXPECT_TRUE(!is_sure || frame.mean_error_mm(*shape, frame.now) < 1.0);
  }
}

TEST(CollinsIntegratedWithBadInput, ContradictoryMatchesAreNeverASureShape) {
  Frame frame;
  Correspondences matches = frame.matches({200, 1.0, 0.0});
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    matches.image_px(i, 0) = frame.rng.uniform(0.0, 639.0);
    matches.image_px(i, 1) = frame.rng.uniform(0.0, 479.0);
  }
  PluginUnderTest plugin(kId);
  for (const Shape* previous :
       {static_cast<const Shape*>(nullptr), static_cast<const Shape*>(&frame.previous)}) {
    const PluginAnswer out = frame.solve(plugin, frame.image, &matches, previous);
    EXPECT_NE(out.status, WEFT_ERROR) << out.message;
    EXPECT_NE(out.status, WEFT_OK);
    if (const auto shape = out.get<Shape>()) {
      EXPECT_EQ(shape->shape_state(), ShapeState::weak);
    }
  }
}

TEST(CollinsIntegratedWithBadInput, WhatIsWrongIsNamed) {
  Frame frame;
  PluginUnderTest plugin(kId);
  Correspondences matches = frame.matches({60, 1.0, 0.0});
  matches.image_px(17, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(frame.solve(plugin, frame.image, &matches).message,
            "match 17 is not finite: leave it out");
  matches = frame.matches({60, 1.0, 0.0});
  matches.face(3) = 9999;
  EXPECT_THAT(frame.solve(plugin, frame.image, &matches).message,
              HasSubstr("match 3 lies in face 9999"));
  matches = frame.matches({60, 1.0, 0.0});
  matches.covariance_px2 = Array<double>({60, 2, 2}, -1.0);
  EXPECT_EQ(frame.solve(plugin, frame.image, &matches).message,
            "match 0 has no positive definite covariance: leave it out");
  Image small;
  small.pixels = Array<std::uint8_t>({10, 10}, 0);
  EXPECT_EQ(frame.solve(plugin, small, nullptr).status, WEFT_ERROR);
}

TEST(CollinsIntegratedWithBadInput, APreviousShapeThatIsNoneIsNotFollowed) {
  Frame frame;
  PluginUnderTest plugin(kId);
  const Correspondences matches = frame.matches({200, 1.0, 0.5});
  const Shape anew = given(frame.solve(plugin, frame.image, &matches));
  Shape with_nan = frame.shape_of(frame.now), behind = frame.shape_of(frame.now),
        other = frame.shape_of(frame.now);
  with_nan.vertices_m(5, 1) = std::numeric_limits<double>::quiet_NaN();
  for (std::int64_t v = 0; v < behind.vertices_m.rows(); ++v) behind.vertices_m(v, 2) *= -1.0;
  other.vertices_m = Array<double>({4, 3}, 1.0);
  other.source = Array<std::uint8_t>({4}, 0);
  for (const Shape& previous : {with_nan, behind, other}) {
    const PluginAnswer out = frame.solve(plugin, frame.image, &matches, &previous);
    ASSERT_EQ(out.status, WEFT_OK) << out.message;
    EXPECT_EQ(given(out).vertices_m.matrix<3>(), anew.vertices_m.matrix<3>());
    EXPECT_EQ(frame.solve(plugin, frame.image, nullptr, &previous).status, WEFT_NO_RESULT);
  }
}

}  // namespace
}  // namespace weft::collins_integrated
