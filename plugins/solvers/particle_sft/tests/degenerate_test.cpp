// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <weft/data/matrix.hpp>

#include "scene.hpp"

namespace weft::particle_sft {
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

TEST(ParticleSftDegenerate, APreviousShapeBehindTheCameraComesToTheFront) {
  const Scene scene = Scene::bent(0.25);
  const Shape previous = shape_of(-scene.truth_m);
  PluginUnderTest plugin(kId);
  const Shape shape = given(scene.run(plugin, &previous));
  EXPECT_GT(shape.vertices_m.matrix<3>().col(2).minCoeff(), 0.0);
  EXPECT_LT(scene.mean_error_m(shape), 0.002);
}

TEST(ParticleSftDegenerate, APreviousShapeInOnePointIsLeft) {
  const Scene scene = Scene::bent(0.25);
  PluginUnderTest plugin(kId);
  for (const Eigen::RowVector3d& point :
       {Eigen::RowVector3d(0.0, 0.0, 0.6), Eigen::RowVector3d(0.0, 0.0, 0.0)}) {
    const Shape previous = shape_of(point.replicate(60, 1));
    EXPECT_LT(scene.mean_error_m(given(scene.run(plugin, &previous))), 0.002) << point;
  }
}

TEST(ParticleSftDegenerate, APreviousShapeThatIsNotFiniteIsNotAStart) {
  const Scene scene = Scene::bent(0.25);
  Points3 before_m = scene.truth_m;
  before_m(5, 1) = std::nan("");
  const Shape previous = shape_of(before_m);
  PluginUnderTest plugin(kId);
  EXPECT_EQ(given(scene.run(plugin, &previous)).diag.value("start", -1.0), 1.0);
}

TEST(ParticleSftDegenerate, TheLastIterationIsTheAnswerWhenTheyRunOut) {
  const Scene scene = Scene::bent(0.25);
  const Shape previous = shape_of(Scene::bent(0.27).truth_m);
  PluginUnderTest plugin(kId, "{max_iterations: 20}");
  const Shape shape = given(scene.run(plugin, &previous));
  EXPECT_EQ(shape.diag.value("stop", -1.0), 2.0);
  EXPECT_EQ(shape.diag.value("iterations", 0.0), 20.0);
}

TEST(ParticleSftDegenerate, WithoutAStartItsReasonIsGiven) {
  Scene scene = Scene::bent(0.25);
  for (std::int64_t i = 0; i < 60; ++i) scene.aim(i, {300.0, 200.0});
  PluginUnderTest plugin(kId);
  const PluginAnswer out = scene.run(plugin);
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  EXPECT_THAT(out.message, HasSubstr("coincide"));
}

TEST(ParticleSftDegenerate, ResidualsOfSomePixelsMakeAWeakShape) {
  constexpr std::uint64_t kSightSeed = 31;
  std::cout << "seed " << kSightSeed << "\n";
  Scene scene = Scene::bent(0.25);
  scene.look(8.0, kSightSeed);
  const Shape previous = shape_of(scene.truth_m);
  PluginUnderTest plugin(kId);
  const Shape shape = given(scene.run(plugin, &previous));
  EXPECT_GE(shape.diag.value("residual_px", 0.0), 3.0);
  EXPECT_LT(shape.diag.value("residual_px", 0.0), 6.0);
  EXPECT_EQ(shape.shape_state(), ShapeState::weak);
}

TEST(ParticleSftDegenerate, SightlinesWithoutWeightDoNotCount) {
  Scene scene = Scene::bent(0.25);
  for (std::int64_t i = 2; i < 60; ++i) scene.lines.weight(i) = 0.0;
  PluginUnderTest plugin(kId);
  const PluginAnswer out = scene.run(plugin);
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  EXPECT_EQ(out.message, "too few sightlines: 2 of at least 3");
}

TEST(ParticleSftDegenerate, NumbersThatAreNotFiniteAreErrorsThatNameTheirPlace) {
  Scene scene = Scene::bent(0.25);
  PluginUnderTest plugin(kId);
  const KnownPoints known = known_points({4, 5}, Points3::Constant(2, 3, std::nan("")), 0.01);
  const PluginAnswer point = scene.run(plugin, nullptr, &known);
  EXPECT_EQ(point.status, WEFT_ERROR);
  EXPECT_THAT(point.message, HasSubstr("known point 0"));
  scene.lines.ray(7, 1) = std::nan("");
  EXPECT_THAT(scene.run(plugin).message, HasSubstr("sightline 7 has no unit ray"));
  scene = Scene::bent(0.25);
  scene.templ.vertices_m(3, 2) = std::nan("");
  EXPECT_EQ(scene.run(plugin).status, WEFT_ERROR);
}

TEST(ParticleSftDegenerate, AKnownPointInItsSphereAlreadyChangesNothing) {
  const Scene scene = Scene::bent(0.25);
  const Shape previous = shape_of(scene.truth_m);
  PluginUnderTest plugin(kId);
  const KnownPoints known = known_points({20}, scene.truth_m.row(20), 0.05);
  EXPECT_EQ(Points3(given(scene.run(plugin, &previous, &known)).vertices_m.matrix<3>()),
            Points3(given(scene.run(plugin, &previous)).vertices_m.matrix<3>()));
}

}  // namespace
}  // namespace weft::particle_sft
