// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

#include "common/tests/matched_scene.hpp"

namespace weft::solvers {

/// A solver of matches, and how it answers those from which no shape follows.
struct SolverCase {
  const char* id;
  const char* params = "{}";
  std::vector<int> too_few = {0, 1, 3, 9};
  const char* of_few = "too few matches";  ///< in the message, with the number
  const char* of_heap = "coincide";        ///< in the message about matches in one pixel
  const char* of_nan = "match 17 is not finite: leave it out";
  double most_confidence = 0.5;  ///< where matches contradict each other
  double radius_m = 0.25;
  testing::PoseSpec pose = kTurned;
  double zoom = 1.0;  ///< factor on the focal length
  /// A shape that is marked as degenerate will do, too, and a message without a number.
  bool may_be_degenerate = false;
};

inline void PrintTo(const SolverCase& given, std::ostream* out) {
  *out << given.id << ' ' << given.params;
}

/// The tests for every solver of matches; a test program instantiates it with its solver.
class DegenerateMatches : public ::testing::TestWithParam<SolverCase> {
 protected:
  static MatchedScene scene_of(int count, std::uint64_t seed) {
    const SolverCase& given = GetParam();
    return {given.radius_m, {count}, seed, {}, given.pose, given.zoom};
  }
  static SolverCall call(const MatchedScene& scene) {
    return {GetParam().id, GetParam().params, scene};
  }
  static void expect_no_result(const MatchedScene& scene, const std::string& reason = "") {
    const SolverCall solver = call(scene);
    const bool is_marked = solver.out.status == WEFT_DEGENERATE && GetParam().may_be_degenerate;
    EXPECT_TRUE(solver.out.status == WEFT_NO_RESULT || is_marked) << solver.out.message;
    EXPECT_FALSE(solver.out.message.empty());
    EXPECT_THAT(solver.out.message, ::testing::HasSubstr(reason));
  }
  static void expect_no_sure_shape(const MatchedScene& scene) {
    const SolverCall solver = call(scene);
    EXPECT_NE(solver.out.status, WEFT_ERROR) << solver.out.message;
    if (const auto shape = solver.shape()) {
      EXPECT_EQ(shape->shape_state(), ShapeState::weak);
      EXPECT_LT(shape->confidence, GetParam().most_confidence);
    }
  }
};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(DegenerateMatches);

TEST_P(DegenerateMatches, AreNoResultWhereTheyAreTooFew) {
  for (const int count : GetParam().too_few) {
    expect_no_result(scene_of(count, 6), GetParam().of_few);
    if (!GetParam().may_be_degenerate) expect_no_result(scene_of(count, 6), std::to_string(count));
  }
}

TEST_P(DegenerateMatches, AreNoResultOnALineOfTheTemplate) {
  MatchedScene scene = scene_of(60, 7);
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    const double along = static_cast<double>(i) / 60.0;
    scene.matches.face(i) = 10;
    scene.matches.barycentrics.matrix<3>().row(i) << 1.0 - along, along, 0.0;
    scene.matches.template_px(i, 1) = 200.0;
  }
  expect_no_result(scene);
}

TEST_P(DegenerateMatches, AreNoResultInOnePixel) {
  MatchedScene scene = scene_of(60, 7);
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    scene.matches.image_px(i, 0) = 300.0;
    scene.matches.image_px(i, 1) = 200.0;
  }
  const SolverCall solver = call(scene);
  EXPECT_EQ(solver.out.status, WEFT_NO_RESULT) << solver.out.message;
  EXPECT_THAT(solver.out.message, ::testing::HasSubstr(GetParam().of_heap));
}

TEST_P(DegenerateMatches, AreNeverASureShapeWhereTheyContradictEachOther) {
  for (std::uint64_t seed = 9; seed < 15; ++seed) {
    std::cout << "seed of the pixels " << seed << "\n";
    MatchedScene scene = scene_of(200, 8);
    Rng rng(seed);
    for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
      scene.matches.image_px(i, 0) = rng.uniform(0.0, 639.0);
      scene.matches.image_px(i, 1) = rng.uniform(0.0, 479.0);
    }
    expect_no_sure_shape(scene);
  }
}

TEST_P(DegenerateMatches, AreNoShapeWhereOneIsNotANumber) {
  MatchedScene scene = scene_of(200, 8);
  scene.matches.image_px(17, 0) = std::nan("");
  const SolverCall solver = call(scene);
  EXPECT_NE(solver.out.status, WEFT_OK);
  EXPECT_FALSE(solver.out.message.empty());
  EXPECT_THAT(solver.out.message, ::testing::HasSubstr(GetParam().of_nan));
  if (*GetParam().of_nan != '\0') {
    EXPECT_EQ(solver.out.status, WEFT_ERROR);
  }
}

}  // namespace weft::solvers
