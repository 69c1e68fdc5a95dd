// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <limits>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/data/visibility.hpp>

#include "common/tests/degenerate_matches.hpp"
#include "minimiser.hpp"
#include "scene.hpp"

namespace weft::solvers {

INSTANTIATE_TEST_SUITE_P(
    GaussNewton, DegenerateMatches,
    ::testing::Values(SolverCase{
        .id = "solvers/gauss_newton", .of_few = "", .of_heap = "", .of_nan = "match 17"}));

}  // namespace weft::solvers

namespace weft::gauss_newton {
namespace {

using ::testing::HasSubstr;
using testing::PluginAnswer;
using testing::PluginUnderTest;

Shape given(const PluginAnswer& out) {
  EXPECT_TRUE(out.status == WEFT_OK || out.status == WEFT_DEGENERATE) << out.message;
  const Shape shape = out.get<Shape>().value();
  EXPECT_TRUE(shape.vertices_m.matrix<3>().allFinite());
  return shape;
}

/// Matches of the smooth surface that a pose bends, and the places of its vertices.
struct Matched {
  Scene scene;
  Correspondences matches;

  Matched(const BentPose& bent, testing::MatchSpec spec, std::uint64_t seed)
      : scene(Scene::bent(bent.radius_m, bent.pose)) {
    Rng rng(seed);
    const auto sheet = testing::make_cylinder(reference_sheet(), bent.radius_m, 0.3, bent.pose);
    matches = testing::draw_matches(scene.templ, scene.camera, sheet, spec, rng).matches;
  }
  PluginAnswer run(PluginUnderTest& plugin, const Shape* previous = nullptr,
                   const KnownPoints* known = nullptr) const {
    return scene.run(plugin, previous, known, &matches);
  }
};

struct Errors {
  double mean_mm = 0.0, worst_mm = 0.0;
};

/// Over the 24 reference poses, from the convex start or beside the truth.
Errors errors_of(const testing::MatchSpec& spec, bool is_near, const std::string& params = "{}") {
  std::cout << "seeds from " << kSeed << "\n";
  PluginUnderTest plugin(kId, params);
  Errors errors;
  std::uint64_t seed = kSeed;
  for (const BentPose& bent : reference_poses()) {
    const Matched matched(bent, spec, seed++);
    testing::PoseSpec before = bent.pose;
    before.x_m += 0.01;
    const Shape previous = shape_of(Scene::bent(1.1 * bent.radius_m, before).truth_m);
    const Shape shape = given(matched.run(plugin, is_near ? &previous : nullptr));
    const double error_mm = 1e3 * matched.scene.mean_error_m(shape);
    errors.mean_mm += error_mm / 24.0;
    errors.worst_mm = std::max(errors.worst_mm, error_mm);
  }
  std::cout << "mean " << errors.mean_mm << " mm, worst " << errors.worst_mm << " mm\n";
  return errors;
}

TEST(GaussNewton, ExactMatchesOfABentSheetGiveItsShape) {
  for (const bool is_near : {true, false}) {
    const Errors errors = errors_of({300, 1.0, 0.0}, is_near);
    EXPECT_LT(errors.mean_mm, 0.3);
    EXPECT_LT(errors.worst_mm, 0.6);
  }
}

TEST(GaussNewton, HalfAPixelOfNoiseCostsLessThanAMillimetre) {
  for (const bool is_near : {true, false}) {
    const Errors errors = errors_of({300, 1.0, 0.5}, is_near);
    EXPECT_LT(errors.mean_mm, 0.6);
    EXPECT_LT(errors.worst_mm, 1.5);
  }
}

TEST(GaussNewton, AThirdOfWrongMatchesIsLeftAlone) {
  const Errors clean = errors_of({300, 1.0, 0.5}, true), wrong = errors_of({400, 0.7, 0.5}, true);
  EXPECT_LT(wrong.mean_mm, clean.mean_mm + 0.2);
}

/// Each match is off by 4 px along a separate direction and by 0.1 px across it, and its covariance
/// has these values.
void blur(Correspondences& matches, std::uint64_t seed) {
  std::cout << "seed of the blur " << seed << "\n";
  Rng rng(seed);
  matches.covariance_px2 = Array<double>({matches.count(), 2, 2});
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    const double turn_rad = std::acos(-1.0) * rng.uniform();
    const Eigen::Vector2d along(std::cos(turn_rad), std::sin(turn_rad)),
        across = {-along.y(), along.x()};
    const Eigen::Matrix2d covariance =
        16.0 * along * along.transpose() + 0.01 * across * across.transpose();
    for (int k = 0; k < 4; ++k) matches.covariance_px2.row(i)[k] = covariance(k / 2, k % 2);
    const Eigen::Vector2d off = 4.0 * rng.normal() * along + 0.1 * rng.normal() * across;
    matches.image_px.matrix<2>().row(i) += off.transpose();
  }
}

TEST(GaussNewton, TrustsAMatchAlongEachDirectionAsItsCovarianceSays) {
  Matched matched({0.25, {0.6, 0, 0, 0.3, 0, 0}}, {300, 1.0, 0.0}, kSeed);
  const Shape previous = shape_of(Scene::bent(0.28, {0.61, 0.005, 0, 0.3, 0, 0}).truth_m);
  blur(matched.matches, kSeed + 1);
  PluginUnderTest plugin(kId);
  const double informed_m = matched.scene.mean_error_m(given(matched.run(plugin, &previous)));
  matched.matches.covariance_px2 = {};
  const double uninformed_m = matched.scene.mean_error_m(given(matched.run(plugin, &previous)));
  EXPECT_LT(1e3 * informed_m, 0.5);
  EXPECT_LT(informed_m, 0.5 * uninformed_m);
}

TEST(GaussNewton, TheSameCovarianceForAllIsTheSameNoiseForAll) {
  Matched matched({0.25, {0.6, 0, 0, 0.3, 0, 0}}, {300, 0.8, 0.5}, kSeed);
  PluginUnderTest by_noise(kId, "{match_noise_px: 0.7}"),
      by_covariance(kId, "{covariance_noise_px: 0}");
  const Shape expected = given(matched.run(by_noise));
  matched.matches.covariance_px2 = Array<double>({matched.matches.count(), 2, 2});
  for (std::int64_t i = 0; i < matched.matches.count(); ++i) {
    double* covariance = matched.matches.covariance_px2.row(i);
    covariance[0] = covariance[3] = 0.7 * 0.7;
    covariance[1] = covariance[2] = 0.0;
  }
  const Shape found = given(matched.run(by_covariance));
  const Points3 difference_m = found.vertices_m.matrix<3>() - expected.vertices_m.matrix<3>();
  EXPECT_LT(difference_m.cwiseAbs().maxCoeff(), 1e-9);
}

/// m, root mean square of the standard deviations of the depths.
double depth_deviation_m(const Shape& shape) {
  double squares = 0.0;
  for (std::int64_t v = 0; v < shape.vertices_m.rows(); ++v)
    squares += shape.covariance_m2.row(v)[8];
  return std::sqrt(squares / static_cast<double>(shape.vertices_m.rows()));
}

TEST(GaussNewton, ResidualsThatAreOffTogetherCountAsOne) {
  std::cout << "seed " << kSeed << "\n";
  const BentPose pose{0.25, {0.6, 0, 0, 0.3, 0, 0}};
  const Matched scattered(pose, {2000, 1.0, 1.0}, kSeed);
  Matched together(pose, {2000, 1.0, 0.0}, kSeed);
  for (std::int64_t i = 0; i < together.matches.count(); ++i) {
    // A wave of 200 px and 1.4 px across the surface, which no bending explains.
    const double phase = 0.0314 * together.matches.image_px(i, 0);
    together.matches.image_px(i, 1) += 1.4 * std::sin(phase);
  }
  PluginUnderTest plugin(kId, "{scale_noise: 0}");
  const Shape of_scattered = given(scattered.run(plugin)),
              of_together = given(together.run(plugin));
  EXPECT_LT(of_scattered.diag.value("coherence", 0.0), 1.5);
  EXPECT_GT(of_together.diag.value("coherence", 0.0), 4.0);
  EXPECT_GT(depth_deviation_m(of_together), 1.3 * depth_deviation_m(of_scattered));
}

TEST(GaussNewton, DepthsAreAsUncertainAsTheSizesThatAreNotKnown) {
  const Matched matched({0.25, {0.6, 0, 0, 0.3, 0, 0}}, {300, 1.0, 0.0}, kSeed);
  PluginUnderTest known(kId, "{scale_noise: 0}"), guessed(kId, "{scale_noise: 0.02}");
  EXPECT_LT(1e3 * depth_deviation_m(given(matched.run(known))), 1.5);
  EXPECT_NEAR(1e3 * depth_deviation_m(given(matched.run(guessed))), 0.02 * 600.0, 2.0);
}

TEST(GaussNewton, AnAssumedFocalLengthMakesDepthsUncertain) {
  Matched matched({0.25, {0.6, 0, 0, 0.3, 0, 0}}, {300, 1.0, 0.0}, kSeed);
  PluginUnderTest plugin(kId, "{scale_noise: 0}");
  const double calibrated_m = depth_deviation_m(given(matched.run(plugin)));
  CameraAssumption{0.1 * matched.scene.camera.fx, 10.0, 10.0, "a test"}.add_to(
      matched.scene.camera);
  const double assumed_m = depth_deviation_m(given(matched.run(plugin)));
  EXPECT_LT(1e3 * calibrated_m, 1.5);
  EXPECT_NEAR(1e3 * assumed_m, 0.1 * 600.0, 5.0);
}

TEST(GaussNewton, BothBendsArePossibleWhereTheSheetIsFarAway) {
  // At this distance there is no perspective, and a surface that bends to the other side looks the
  // same.
  std::cout << "seed " << kSeed << "\n";
  Matched matched({0.12, {0.6, 0, 0, 0, 0, 0}}, {100, 1.0, 0.0}, kSeed);
  Scene& scene = matched.scene;
  constexpr double kFurther = 40.0;
  const testing::PoseSpec far{0.6 * kFurther, 0, 0, 0, 0, 0};
  const auto sheet = testing::make_cylinder(reference_sheet(), 0.12, 0.3, far);
  scene.truth_m = testing::bent_vertices(scene.templ, sheet);
  scene.camera.fx *= kFurther;
  scene.camera.fy *= kFurther;
  Rng rng(kSeed);
  matched.matches =
      testing::draw_matches(scene.templ, scene.camera, sheet, {100, 1.0, 0.5}, rng).matches;
  scene.look();
  PluginUnderTest plugin(kId);
  const Shape shape = given(matched.run(plugin));
  EXPECT_GT(shape.diag.value("rival", 0.0), 0.1);
  EXPECT_LT(shape.confidence, 0.9);
  EXPECT_GT(1e3 * depth_deviation_m(shape), 10.0);
}

TEST(GaussNewton, GoesOnWithTheBendOfTheSeenPartWhereTheSheetIsHidden) {
  Matched matched({0.12, {0.6, 0, 0, 0, 0, 0}}, {600, 1.0, 0.0}, kSeed);
  Visibility sight;
  sight.visible = Array<std::uint8_t>({60});
  sight.reason = Array<std::uint8_t>({60});
  sight.score = Array<double>({60});
  for (std::int64_t v = 0; v < 60; ++v) {
    const bool is_seen = v % 10 >= 2 && v % 10 <= 7;
    sight.visible(v) = is_seen ? 1 : 0;
    sight.reason(v) = static_cast<std::uint8_t>(is_seen ? SightReason::seen : SightReason::hidden);
    sight.score(v) = is_seen ? 1.0 : 0.0;
  }
  const auto faces = matched.scene.templ.faces.matrix<3>();
  for (std::int64_t i = 0; i < matched.matches.count(); ++i) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      if (sight.visible(faces(matched.matches.face(i), k)) == 0) matched.matches.kept(i) = 0;
    }
  }
  const auto error_m = [&](const std::string& params) {
    PluginUnderTest plugin(kId, params);
    const Shape shape = given(plugin.process(0, {testing::input("template", matched.scene.templ),
                                                 testing::input("camera", matched.scene.camera),
                                                 testing::input("correspondences", matched.matches),
                                                 testing::input("sightlines", matched.scene.lines),
                                                 testing::input("visibility", sight)}));
    double sum_m = 0.0;
    for (std::int64_t v = 0; v < 60; ++v) {
      const Eigen::RowVector3d off_m =
          shape.vertices_m.matrix<3>().row(v) - matched.scene.truth_m.row(v);
      sum_m += sight.visible(v) == 0 ? off_m.norm() / 24.0 : 0.0;
    }
    return sum_m;
  };
  const double with_m = error_m("{}");
  const double without_m = error_m("{continue_hidden_bend: false, continue_uncovered_bend: false}");
  std::cout << "hidden part " << 1e3 * with_m << " mm, without " << 1e3 * without_m << " mm\n";
  EXPECT_LT(with_m, 0.5 * without_m);
}

TEST(GaussNewton, ContinuesFromThePreviousShape) {
  const Matched matched({0.25, {0.6, 0, 0, 0, 0, 0}}, {300, 1.0, 0.0}, kSeed);
  const Shape previous = shape_of(Scene::bent(0.3, {0.61, 0.005, 0, 0.05, 0, 0}).truth_m);
  PluginUnderTest plugin(kId);
  const Shape shape = given(matched.run(plugin, &previous));
  EXPECT_EQ(shape.diag.value("start", -1.0), 0.0);
  EXPECT_EQ(shape.diag.value("starts_tried", 0.0), 1.0);
  EXPECT_EQ(shape.shape_state(), ShapeState::estimated);
}

TEST(GaussNewton, AnObjectThatIsCurvedAtRestAlsoBeginsFromItsPosedRestShape) {
  const BentPose posed{0.06, {0.6, 0, 0, 0.3, 0, 0}};
  Matched matched(posed, {300, 1.0, 0.5}, kSeed);
  matched.scene.templ.vertices_m = make_array<double>(testing::bent_vertices(
      matched.scene.templ,
      testing::make_cylinder(reference_sheet(), posed.radius_m, 0.3, {0, 0, 0, 0, 0, 0})));
  // The nested guess is the rest shape without its tilt, from which the solver ends elsewhere or at
  // a higher energy.
  PluginUnderTest plugin(kId,
                         "{initial_guess: {use: solvers/initial_guess, params: {shape: frontal}}}");
  const Shape shape = given(matched.run(plugin));
  EXPECT_EQ(shape.diag.value("start", -1.0), 4.0);
  EXPECT_GE(shape.diag.value("starts_tried", 0.0), 2.0);
  EXPECT_EQ(shape.shape_state(), ShapeState::estimated);
  EXPECT_LT(1e3 * matched.scene.mean_error_m(shape), 0.5);
}

TEST(GaussNewton, TriesNoOtherStartThanThePreviousShapeWhereItGoesOn) {
  const Matched matched({0.25, {0.6, 0, 0, 0, 0, 0}}, {300, 1.0, 0.0}, kSeed);
  // Half of the surface's size aside: taken for an object that jumped.
  const Shape previous = shape_of(Scene::bent(0.3, {0.6, 0.15, 0, 0, 0, 0}).truth_m);
  const auto starts_tried = [&](const char* params) {
    PluginUnderTest plugin(kId, params);
    const Shape shape = given(matched.run(plugin, &previous));
    EXPECT_LT(1e3 * matched.scene.mean_error_m(shape), 1.0) << params;
    return shape.diag.value("starts_tried", 0.0);
  };
  EXPECT_EQ(starts_tried("{previous_only: true}"), 1.0);
  EXPECT_GT(starts_tried("{}"), 1.0);
}

TEST(GaussNewton, IsWeakWhereASpentBudgetLeavesOutAnotherStart) {
  const Matched matched({0.25, {0.6, 0, 0, 0, 0, 0}}, {300, 1.0, 0.0}, kSeed);
  const Shape jumped = shape_of(Scene::bent(0.3, {0.6, 0.15, 0, 0, 0, 0}).truth_m);
  PluginUnderTest plugin(kId);
  const Shape unbounded = given(matched.run(plugin, &jumped));
  plugin.set_budget_ms(-1.0);
  const Shape cut = given(matched.run(plugin, &jumped));
  EXPECT_EQ(cut.diag.value("starts_tried", 0.0), 1.0);
  EXPECT_EQ(cut.diag.value("starts_cut", 0.0), 1.0);
  EXPECT_EQ(cut.diag.value("stop", 0.0), static_cast<double>(Stop::budget));
  EXPECT_EQ(cut.diag.value("iterations", 0.0), 1.0);
  EXPECT_EQ(cut.shape_state(), ShapeState::weak);
  plugin.set_budget_ms(1e9);
  const Shape in_time = given(matched.run(plugin, &jumped));
  EXPECT_EQ(in_time.diag.value("starts_cut", 1.0), 0.0);
  EXPECT_EQ(in_time.vertices_m.matrix<3>(), unbounded.vertices_m.matrix<3>());
}

TEST(GaussNewton, LeavesAPreviousShapeThatIsFoldedOrBehindTheCamera) {
  const Matched matched({0.25, {0.6, 0, 0, 0, 0, 0}}, {300, 1.0, 0.0}, kSeed);
  Points3 folded_m = matched.scene.truth_m;
  for (Eigen::Index v = 0; v < 60; ++v) {
    if (v % 10 >= 5) folded_m.row(v) = matched.scene.truth_m.row(v - 2 * (v % 10) + 9);
  }
  const Points3 in_a_point = Points3(Eigen::RowVector3d(0.0, 0.0, 0.6).replicate(60, 1));
  for (const Points3& wrong : {folded_m, Points3(-matched.scene.truth_m), in_a_point}) {
    const Shape previous = shape_of(wrong);
    PluginUnderTest plugin(kId);
    EXPECT_LT(1e3 * matched.scene.mean_error_m(given(matched.run(plugin, &previous))), 1.0);
  }
}

TEST(GaussNewton, SolvesFromSightlinesWhereNoMatchesAreWired) {
  const Scene scene = Scene::bent(0.25);
  PluginUnderTest plugin(kId);
  EXPECT_LT(1e3 * scene.mean_error_m(given(scene.run(plugin))), 1.0);
}

TEST(GaussNewton, KnownPointsStayWithinTheirRadius) {
  const Matched matched({0.25, {0.6, 0, 0, 0, 0, 0}}, {300, 1.0, 0.0}, kSeed);
  Points3 centres_m(2, 3);
  centres_m << matched.scene.truth_m.row(0), matched.scene.truth_m.row(9);
  centres_m.col(1).array() += 0.006;
  PluginUnderTest plugin(kId);
  for (const double radius_m : {0.0, 0.004}) {
    const KnownPoints known = known_points({0, 9}, centres_m, radius_m);
    const Shape shape = given(matched.run(plugin, nullptr, &known));
    for (Eigen::Index p = 0; p < 2; ++p) {
      const Eigen::RowVector3d vertex_m = shape.vertices_m.matrix<3>().row(p == 0 ? 0 : 9);
      EXPECT_LE((vertex_m - centres_m.row(p)).norm(), radius_m + 1e-9);
    }
  }
}

TEST(GaussNewton, GivesTheSameBytesFreshAndWarm) {
  const Matched first({0.12, {0.6, 0, 0, 0.3, 0, 0}}, {300, 0.8, 0.5}, kSeed);
  const Matched second({-0.25, {0.6, 0, 0, 0, 0.3, 0}}, {100, 0.8, 0.5}, kSeed + 1);
  PluginUnderTest warm(kId), fresh(kId);
  given(first.run(warm));
  EXPECT_EQ(given(second.run(warm)).vertices_m.matrix<3>(),
            given(second.run(fresh)).vertices_m.matrix<3>());
}

TEST(GaussNewtonDegenerate, MatchesOnALineOrInOnePlaceAreNoResult) {
  for (const bool in_one_place : {true, false}) {
    Matched matched({0.25, {0.6, 0, 0, 0, 0, 0}}, {60, 1.0, 0.0}, kSeed);
    for (std::int64_t i = 0; i < matched.matches.count(); ++i) {
      matched.matches.image_px(i, 1) = 240.0;
      if (in_one_place) matched.matches.image_px(i, 0) = 320.0;
    }
    PluginUnderTest plugin(kId);
    const PluginAnswer out = matched.run(plugin);
    EXPECT_EQ(out.status, WEFT_NO_RESULT);
    EXPECT_THAT(out.message, HasSubstr("on a line"));
  }
}

TEST(GaussNewtonDegenerate, MatchesThatContradictEachOtherAreNoShapeToBeTrusted) {
  const Matched matched({0.25, {0.6, 0, 0, 0, 0, 0}}, {300, 0.02, 0.0}, kSeed);
  PluginUnderTest plugin(kId);
  const PluginAnswer out = matched.run(plugin);
  if (out.status == WEFT_NO_RESULT) return;
  EXPECT_NE(given(out).shape_state(), ShapeState::estimated);
}

TEST(GaussNewtonDegenerate, CovariancesThatAreNoneAreNamed) {
  const Matched exact({0.25, {0.6, 0, 0, 0, 0, 0}}, {60, 1.0, 0.0}, kSeed);
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  for (const auto& wrong : std::vector<std::array<double, 4>>{
           {nan, 0, 0, 1}, {1, nan, 0, 1}, {infinite, 0, 0, 1}, {-1, 0, 0, 1}, {1, 5, 5, 1}}) {
    Matched matched = exact;
    matched.matches.covariance_px2 = Array<double>({60, 2, 2});
    for (std::int64_t i = 0; i < 60; ++i) {
      const std::array<double, 4> right{0.01, 0.0, 0.0, 0.01};
      const auto& values = i == 7 ? wrong : right;
      std::copy(values.begin(), values.end(), matched.matches.covariance_px2.row(i));
    }
    PluginUnderTest plugin(kId);
    const PluginAnswer out = matched.run(plugin);
    EXPECT_EQ(out.status, WEFT_ERROR);
    EXPECT_THAT(out.message, HasSubstr("match 7"));
  }
}

TEST(GaussNewtonDegenerate, KnownPointsFartherThanTheSurfaceAllowsAreRelaxed) {
  const Matched matched({0.25, {0.6, 0, 0, 0, 0, 0}}, {300, 1.0, 0.0}, kSeed);
  Points3 centres_m(2, 3);
  centres_m << matched.scene.truth_m.row(0), matched.scene.truth_m.row(9);
  centres_m(0, 0) -= 0.05;
  centres_m(1, 0) += 0.05;
  const KnownPoints known = known_points({0, 9}, centres_m, 0.0);
  PluginUnderTest plugin(kId);
  const PluginAnswer out = matched.run(plugin, nullptr, &known);
  EXPECT_EQ(out.status, WEFT_DEGENERATE);
  EXPECT_THAT(out.message, HasSubstr("larger distances than the surface allows"));
}

}  // namespace
}  // namespace weft::gauss_newton
