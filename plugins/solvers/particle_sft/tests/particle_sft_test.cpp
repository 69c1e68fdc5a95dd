// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

#include "scene.hpp"

namespace weft::particle_sft {
namespace {

using testing::PluginAnswer;
using testing::PluginUnderTest;

Shape solved(const PluginAnswer& out) {
  EXPECT_EQ(out.status, WEFT_OK) << out.message;
  return out.get<Shape>().value();
}

Points3 vertices_of(const Shape& shape) { return shape.vertices_m.matrix<3>(); }

double start_of(const Shape& shape) { return shape.diag.value("start", -1.0); }

/// Inliers without noise.
Correspondences matches_of(const Scene& scene, int count) {
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  return testing::draw_matches(scene.templ, scene.camera, scene.truth_m, {count, 1.0, 0.0}, rng)
      .matches;
}

TEST(ParticleSft, TheReferenceTableFromTheConvexStart) {
  std::cout << "seeds from " << kSeed << "\n";
  PluginUnderTest plugin(kId);
  double sum_m = 0.0, worst_m = 0.0;
  std::uint64_t seed = kSeed;
  for (const auto& [radius_m, pose] : reference_poses()) {
    Scene scene = Scene::bent(radius_m, pose);
    scene.look(0.5, seed++);
    const Shape shape = solved(scene.run(plugin));
    EXPECT_EQ(start_of(shape), 1.0);
    EXPECT_EQ(shape.shape_state(), ShapeState::estimated);
    sum_m += scene.mean_error_m(shape);
    worst_m = std::max(worst_m, scene.mean_error_m(shape));
  }
  std::cout << "mean " << 1e3 * sum_m / 24.0 << " mm, worst " << 1e3 * worst_m << " mm\n";
  EXPECT_LT(sum_m / 24.0, 0.0015);
  EXPECT_LT(worst_m, 0.0040);
}

TEST(ParticleSft, FourTenthsOfTheVerticesAreEnoughNextToThePreviousShape) {
  std::cout << "seeds from " << kSeed << "\n";
  PluginUnderTest plugin(kId);
  double sum_m = 0.0;
  std::uint64_t seed = kSeed;
  for (const auto& [radius_m, pose] : reference_poses()) {
    Scene scene = Scene::bent(radius_m, pose);
    Rng rng(seed);
    scene.seen.clear();
    for (std::int32_t v = 0; v < 60; ++v) {
      if (rng.uniform() < 0.4) scene.seen.push_back(v);
    }
    scene.look(0.5, seed++);
    testing::PoseSpec before = pose;
    before.x_m += 0.01;
    const Shape previous = shape_of(Scene::bent(1.1 * radius_m, before).truth_m);
    const Shape shape = solved(scene.run(plugin, &previous));
    for (std::int32_t v = 0; v < 60; ++v) {
      EXPECT_EQ(shape.source(v), std::count(scene.seen.begin(), scene.seen.end(), v));
    }
    sum_m += scene.mean_error_m(shape);
  }
  std::cout << "mean " << 1e3 * sum_m / 24.0 << " mm\n";
  EXPECT_LT(sum_m / 24.0, 0.0034);
}

TEST(ParticleSft, ContinuesFromThePreviousShape) {
  const Scene scene = Scene::bent(0.25);
  const Shape previous = shape_of(Scene::bent(0.3, {0.61, 0.005, 0, 0.05, 0, 0}).truth_m);
  PluginUnderTest plugin(kId);
  const Shape shape = solved(scene.run(plugin, &previous));
  EXPECT_EQ(start_of(shape), 0.0);
  EXPECT_EQ(shape.diag.value("starts_tried", 0.0), 1.0);
  EXPECT_LT(scene.mean_error_m(shape), 0.002);
}

TEST(ParticleSft, DampsNearStartsAloneByTheirOwnDamping) {
  const Scene scene = Scene::bent(0.25);
  const Shape previous = shape_of(Scene::bent(0.27, {0.602, 0.001, 0, 0.01, 0, 0}).truth_m);
  PluginUnderTest usual(kId), damped(kId, "{tracked_damping: 0.05}");
  const Shape slow = solved(scene.run(usual, &previous)),
              fast = solved(scene.run(damped, &previous));
  EXPECT_LT(fast.diag.value("iterations", 0.0), slow.diag.value("iterations", 0.0));
  EXPECT_LT(scene.mean_error_m(fast), 0.002);
  const Shape moved = shape_of(Scene::bent(0.27, {0.6, 0.03, 0, 0, 0, 0}).truth_m);
  const Shape usual_moved = solved(scene.run(usual, &moved));
  EXPECT_EQ(usual_moved.vertices_m.matrix<3>(),
            solved(scene.run(damped, &moved)).vertices_m.matrix<3>());
  const Shape usual_convex = solved(scene.run(usual)), damped_convex = solved(scene.run(damped));
  EXPECT_EQ(usual_convex.vertices_m.matrix<3>(), damped_convex.vertices_m.matrix<3>());
}

TEST(ParticleSft, BeginsWithTheConstantsOfItsPreset) {
  Scene scene = Scene::bent(0.25);
  scene.look(0.5, kSeed);
  const Shape lost = shape_of(Scene::bent(-0.3).truth_m, ShapeState::lost);
  const auto vertices_m = [&](const std::string& params, const Shape* previous) {
    PluginUnderTest plugin(kId, params);
    return vertices_of(solved(scene.run(plugin, previous)));
  };
  const std::string common =
      "damping: 0.008, tracked_damping: 0.008, stretch_stiffness: 1, bend_stiffness: 1, "
      "solver_iterations: 2, max_iterations: 2000, ";
  const std::string author = "{" + common +
                             "tolerance_m: 1.0e-5, initial_guess_smoothing: 0, multi_start: false, "
                             "continue_hidden_bend: false, "
                             "continue_uncovered_bend: false, ";
  const std::string weft = "{" + common +
                           "tolerance_m: 1.0e-6, initial_guess_smoothing: 1.5, multi_start: true, "
                           "continue_hidden_bend: true, "
                           "continue_uncovered_bend: true, ";
  for (const Shape* previous : {static_cast<const Shape*>(nullptr), &lost}) {
    const Points3 author_m = vertices_m("{preset: author}", previous);
    const Points3 weft_m = vertices_m("{}", previous);
    EXPECT_EQ(weft_m, vertices_m("{preset: weft}", previous));
    EXPECT_EQ(weft_m, vertices_m(weft + "preset: author}", previous));
    EXPECT_EQ(author_m, vertices_m(author + "preset: weft}", previous));
    EXPECT_NE(author_m, weft_m);
  }
}

TEST(ParticleSft, TriesAllStartsAfterALoss) {
  const Scene scene = Scene::bent(0.25);
  const Points3 before_m = Scene::bent(0.3).truth_m;
  PluginUnderTest plugin(kId);
  for (const ShapeState state : {ShapeState::predicted, ShapeState::lost}) {
    const Shape previous = shape_of(before_m, state);
    const Shape shape = solved(scene.run(plugin, &previous));
    EXPECT_EQ(shape.diag.value("starts_tried", 0.0), 3.0);
    EXPECT_LT(scene.mean_error_m(shape), 0.002);
  }
}

TEST(ParticleSft, TriesAllStartsAfterAJump) {
  const Scene scene = Scene::bent(0.25, {0.6, 0.06, 0.03, 0, 0, 0});
  const Shape previous = shape_of(Scene::bent(0.3, {0.6, -0.06, -0.03, 0, 0, 0}).truth_m);
  PluginUnderTest plugin(kId);
  const Shape shape = solved(scene.run(plugin, &previous));
  EXPECT_EQ(shape.diag.value("starts_tried", 0.0), 3.0);
  EXPECT_LT(scene.mean_error_m(shape), 0.002);
}

TEST(ParticleSft, IsWeakWhereASpentBudgetLeavesOutTheOtherStarts) {
  const Scene scene = Scene::bent(0.25);
  const Shape previous = shape_of(Scene::bent(0.3).truth_m, ShapeState::predicted);
  PluginUnderTest plugin(kId);
  const Shape unbounded = solved(scene.run(plugin, &previous));
  plugin.set_budget_ms(-1.0);
  const Shape cut = solved(scene.run(plugin, &previous));
  EXPECT_EQ(cut.diag.value("starts_tried", 0.0), 1.0);
  EXPECT_EQ(cut.diag.value("starts_cut", 0.0), 1.0);
  EXPECT_EQ(cut.shape_state(), ShapeState::weak);
  plugin.set_budget_ms(1e9);
  const Shape in_time = solved(scene.run(plugin, &previous));
  EXPECT_EQ(in_time.diag.value("starts_cut", 1.0), 0.0);
  EXPECT_EQ(in_time.vertices_m.matrix<3>(), unbounded.vertices_m.matrix<3>());
}

TEST(ParticleSft, LeavesAWrongMinimumByTheConvexStart) {
  // Tracked, but folded: the right half lies mirrored on the left one.
  const Scene scene = Scene::bent(0.25);
  Points3 folded_m = scene.truth_m;
  for (Eigen::Index v = 0; v < 60; ++v) {
    if (v % 10 >= 5) folded_m.row(v) = scene.truth_m.row(v - 2 * (v % 10) + 9);
  }
  const Shape previous = shape_of(folded_m);
  PluginUnderTest plugin(kId);
  const Shape shape = solved(scene.run(plugin, &previous));
  EXPECT_LT(scene.mean_error_m(shape), 0.002);
  EXPECT_GE(shape.diag.value("starts_tried", 0.0), 1.0);
}

TEST(ParticleSft, LeavesACornerThatIsFoldedOverThoughAllElseFits) {
  // Three vertices at a corner begin on their rays, but too near or too deep. They converge on the
  // wrong side of the bend, and the mean strain is as small as in the correct shape.
  struct Corner {
    BentPose bent;
    std::vector<Eigen::Index> vertices;
    double nearer;
  };
  const Corner corners[] = {
      {{-0.25, {0.6, 0.0, 0.0, -0.2, -0.5, 0.0}}, {49, 59, 58}, 0.8},
      {{0.25, {0.6, 0.0, 0.0, 0.0, 0.3, 0.0}}, {39, 48, 49, 57, 58, 59}, 1.1}};
  for (const auto& [bent, vertices, nearer] : corners) {
    const Scene scene = Scene::bent(bent.radius_m, bent.pose);
    Points3 folded_m = scene.truth_m;
    for (const Eigen::Index v : vertices) folded_m.row(v) *= nearer;
    const Shape previous = shape_of(folded_m), before = shape_of(scene.truth_m);
    PluginUnderTest plugin(kId);
    const double right_m = scene.mean_error_m(solved(scene.run(plugin, &before)));
    EXPECT_LT(scene.mean_error_m(solved(scene.run(plugin, &previous))), 1.1 * right_m);
  }
}

TEST(ParticleSft, APreviousShapeOfAnotherTemplateIsNotAStart) {
  const Scene scene = Scene::bent(0.25);
  const Shape previous = shape_of(Points3::Ones(59, 3));
  PluginUnderTest plugin(kId);
  EXPECT_EQ(start_of(solved(scene.run(plugin, &previous))), 1.0);
}

TEST(ParticleSft, KnownPointsAreMetExactlyOrWithinTheirRadius) {
  const Scene scene = Scene::bent(0.25);
  const std::vector<std::int32_t> observed{0, 9};
  Points3 centres_m(2, 3);
  centres_m << scene.truth_m.row(0), scene.truth_m.row(9);
  centres_m.col(1).array() += 0.006;
  PluginUnderTest plugin(kId);
  for (const double radius_m : {0.0, 0.004, -1.0}) {
    const KnownPoints known = known_points(observed, centres_m, radius_m);
    const Shape shape = solved(scene.run(plugin, nullptr, &known));
    const double allowed_m = radius_m < 0.0 ? 0.005 : radius_m;
    for (Eigen::Index p = 0; p < 2; ++p) {
      const double distance_m =
          (vertices_of(shape).row(observed[to_index(p)]) - centres_m.row(p)).norm();
      EXPECT_LE(distance_m, allowed_m + 1e-12);
    }
  }
}

TEST(ParticleSft, ASphereForgivesABiasedGripperAndCostsLittleWithoutBias) {
  const Scene scene = Scene::bent(0.25);
  Points3 exact_m(2, 3), biased_m(2, 3);
  exact_m << scene.truth_m.row(20), scene.truth_m.row(29);
  biased_m = exact_m;
  biased_m.col(2).array() += 0.005;
  biased_m(0, 0) -= 0.005;
  PluginUnderTest plugin(kId);
  const auto error_m = [&](const Points3& points_m, double radius_m) {
    const KnownPoints known = known_points({20, 29}, points_m, radius_m);
    return scene.mean_error_m(solved(scene.run(plugin, nullptr, &known)));
  };
  EXPECT_LT(error_m(biased_m, 0.008), error_m(biased_m, 0.0));
  EXPECT_LE(error_m(exact_m, 0.0), error_m(exact_m, 0.008) + 0.001);
}

TEST(ParticleSft, AKnownPointInAFaceIsMet) {
  const Scene scene = Scene::bent(0.25);
  const Faces faces = scene.templ.faces.matrix<3>();
  const Eigen::RowVector3d flat_m = (scene.templ.vertices_m.matrix<3>().row(faces(40, 0)) * 0.2 +
                                     scene.templ.vertices_m.matrix<3>().row(faces(40, 1)) * 0.5 +
                                     scene.templ.vertices_m.matrix<3>().row(faces(40, 2)) * 0.3);
  const auto on_shape = [&](const Points3& shape_m) {
    return Eigen::RowVector3d(0.2 * shape_m.row(faces(40, 0)) + 0.5 * shape_m.row(faces(40, 1)) +
                              0.3 * shape_m.row(faces(40, 2)));
  };
  Points3 centre_m = on_shape(scene.truth_m);
  centre_m(0, 2) -= 0.006;
  PluginUnderTest plugin(kId);
  for (const double radius_m : {0.0, 0.002}) {
    KnownPoints known = known_points({-1}, centre_m, radius_m);
    known.template_xy_m = make_array<double>(flat_m.head<2>());
    const Shape shape = solved(scene.run(plugin, nullptr, &known));
    const double distance_m = (on_shape(vertices_of(shape)) - centre_m.row(0)).norm();
    EXPECT_NEAR(distance_m, radius_m, 1e-12);
    EXPECT_LT(scene.mean_error_m(shape), 0.003);
  }
}

TEST(ParticleSft, KnownPointsAreMeasuredAlsoWhereNothingIsSeen) {
  Scene scene = Scene::bent(0.25);
  scene.seen.clear();
  for (std::int32_t v = 0; v < 60; ++v) {
    if (v % 10 < 6) scene.seen.push_back(v);
  }
  scene.look();
  Points3 centres_m(2, 3);
  centres_m << scene.truth_m.row(9), scene.truth_m.row(59);
  const KnownPoints known = known_points({9, 59}, centres_m, 0.001);
  PluginUnderTest plugin(kId);
  const Shape with = solved(scene.run(plugin, nullptr, &known));
  const Shape without = solved(scene.run(plugin));
  EXPECT_EQ(with.source(9), 1);
  EXPECT_EQ(without.source(9), 0);
  const double error_m = scene.mean_error_m(with), alone_m = scene.mean_error_m(without);
  std::cout << "with " << 1e3 * error_m << " mm, without " << 1e3 * alone_m << " mm\n";
  EXPECT_LT(error_m, 0.003);
  EXPECT_LT(error_m, 0.7 * alone_m);
}

TEST(ParticleSft, KnownPointsThatAreTooDistantAreReportedAndRelaxed) {
  const Scene scene = Scene::bent(0.25);
  Points3 centres_m(2, 3);
  centres_m << scene.truth_m.row(0), scene.truth_m.row(9);
  centres_m(0, 0) -= 0.1;
  const KnownPoints known = known_points({0, 9}, centres_m, 0.002);
  PluginUnderTest plugin(kId);
  const PluginAnswer out = scene.run(plugin, nullptr, &known);
  EXPECT_EQ(out.status, WEFT_DEGENERATE);
  EXPECT_THAT(out.message, ::testing::HasSubstr("known points"));
  const Shape shape = out.get<Shape>().value();
  EXPECT_EQ(shape.diag.value("inconsistent_known_points", 0.0), 1.0);
  EXPECT_LT(scene.mean_error_m(shape), 0.05);
}

TEST(ParticleSft, AKnownPointOnAMissingVertexIsAnError) {
  const Scene scene = Scene::bent(0.25);
  const KnownPoints known = known_points({60}, Points3::Ones(1, 3), 0.0);
  PluginUnderTest plugin(kId);
  const PluginAnswer out = scene.run(plugin, nullptr, &known);
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_THAT(out.message, ::testing::HasSubstr("vertex 60"));
}

TEST(ParticleSft, TakesPointsInsideFaces) {
  Scene scene = Scene::bent(0.25);
  const Faces faces = scene.templ.faces.matrix<3>();
  scene.seen.assign(90, 0);
  scene.look();
  for (std::int32_t f = 0; f < 90; ++f) {
    const Eigen::Vector3d weights(0.5, 0.2, 0.3);
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) point += weights[k] * scene.truth_m.row(faces(f, k)).transpose();
    scene.lines.vertex(f) = -1;
    scene.lines.face(f) = f;
    scene.lines.barycentrics.matrix<3>().row(f) = weights.transpose();
    scene.aim(f, project(testing::pinhole(scene.camera), point));
  }
  PluginUnderTest plugin(kId);
  EXPECT_LT(scene.mean_error_m(solved(scene.run(plugin))), 0.002);
}

TEST(ParticleSft, LittleEvidenceMakesAWeakShape) {
  Scene scene = Scene::bent(0.25);
  const Shape previous = shape_of(scene.truth_m);
  PluginUnderTest plugin(kId);
  const Correspondences some = matches_of(scene, 20), many = matches_of(scene, 142);
  EXPECT_EQ(solved(scene.run(plugin, &previous, nullptr, &many)).shape_state(),
            ShapeState::estimated);
  EXPECT_EQ(solved(scene.run(plugin, &previous, nullptr, &some)).shape_state(), ShapeState::weak);
  scene.seen = {0, 1, 2, 10, 11, 12};
  scene.look();
  EXPECT_EQ(solved(scene.run(plugin, &previous)).shape_state(), ShapeState::weak);
}

TEST(ParticleSft, AShapeThatThreeOf142MatchesSupportIsWeak) {
  const Scene scene = Scene::bent(0.25);
  const Shape previous = shape_of(scene.truth_m);
  Correspondences matches = matches_of(scene, 142);
  for (std::int64_t i = 3; i < matches.count(); ++i) matches.image_px(i, 1) += 25.0;
  PluginUnderTest plugin(kId);
  const PluginAnswer out = scene.run(plugin, &previous, nullptr, &matches);
  const Shape shape = out.get<Shape>().value();
  EXPECT_EQ(shape.diag.value("agreeing_matches", -1.0), 3.0);
  EXPECT_EQ(shape.shape_state(), ShapeState::weak);
}

TEST(ParticleSft, TooLittleEvidenceIsNoResult) {
  Scene scene = Scene::bent(0.25);
  const Correspondences few = matches_of(scene, 9);
  PluginUnderTest plugin(kId);
  EXPECT_EQ(scene.run(plugin, nullptr, nullptr, &few).status, WEFT_NO_RESULT);
  scene.seen = {0, 1};
  scene.look();
  const PluginAnswer out = scene.run(plugin);
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  EXPECT_EQ(out.message, "too few sightlines: 2 of at least 3");
}

TEST(ParticleSft, RaysThatNoShapeMeetsAreNoResult) {
  Scene scene = Scene::bent(0.25);
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  for (std::int64_t i = 0; i < 60; ++i) {
    scene.aim(i, {rng.uniform(0.0, 640.0), rng.uniform(0.0, 480.0)});
  }
  PluginUnderTest plugin(kId);
  EXPECT_EQ(scene.run(plugin).status, WEFT_NO_RESULT);
}

TEST(ParticleSft, FreshAndUsedInstancesAgreeExactly) {
  Scene first = Scene::bent(0.12), second = Scene::bent(-0.25);
  second.seen.resize(41);
  second.look(0.5, kSeed);
  first.templ.revision = second.templ.revision = 7;
  PluginUnderTest used(kId), fresh(kId);
  const Points3 before_m = vertices_of(solved(first.run(used)));
  solved(second.run(used));
  EXPECT_EQ(vertices_of(solved(first.run(used))), before_m);
  EXPECT_EQ(vertices_of(solved(second.run(used))), vertices_of(solved(second.run(fresh))));
}

TEST(ParticleSft, ABrokenTemplateIsAnErrorNotACrash) {
  Scene scene = Scene::bent(0.25);
  scene.templ.faces(0, 0) = 777;
  PluginUnderTest plugin(kId);
  const PluginAnswer out = scene.run(plugin);
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_THAT(out.message, ::testing::HasSubstr("777"));
}

TEST(ParticleSft, RefusesParametersOutsideTheirRange) {
  EXPECT_THROW(PluginUnderTest(kId, "{damping: 1.5}"), std::runtime_error);
  EXPECT_THROW(PluginUnderTest(kId, "{initial_guess: {use: warps/bbs}}"), std::runtime_error);
}

}  // namespace
}  // namespace weft::particle_sft
