// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

#include "scene.hpp"

namespace weft::brunet_mdh {
namespace {

using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr const char* kId = "solvers/brunet_mdh";
constexpr std::uint64_t kSeed = 20240917;

Shape solved(const PluginAnswer& out) {
  EXPECT_EQ(out.status, WEFT_OK) << out.message;
  return out.get<Shape>().value();
}

/// Points inside faces instead of vertices: one near the middle of every face.
void look_at_faces(Scene& scene, double shift) {
  const Faces faces = scene.templ.faces.matrix<3>();
  scene.seen.assign(to_index(faces.rows()), 0);
  scene.look();
  for (std::int32_t f = 0; f < faces.rows(); ++f) {
    const Eigen::Vector3d weights(1.0 / 3.0 + shift, 1.0 / 3.0 - shift, 1.0 / 3.0);
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) point += weights[k] * scene.truth_m.row(faces(f, k)).transpose();
    scene.lines.vertex(f) = -1;
    scene.lines.face(f) = f;
    scene.lines.barycentrics.matrix<3>().row(f) = weights.transpose();
    scene.aim(f, project(testing::pinhole(scene.camera), point));
  }
}

TEST(BrunetMdh, FindsBentSheetsFromExactRays) {
  PluginUnderTest plugin(kId);
  for (const double radius_m : {0.25, -0.25, 0.12, -0.12}) {
    for (const double tilt_rad : {-0.4, 0.0, 0.4}) {
      const Scene scene = Scene::bent(radius_m, {0.6, 0.0, 0.0, tilt_rad, 0.2, 0.0});
      const Shape shape = solved(scene.run(plugin));
      EXPECT_LT(scene.mean_error_m(shape), 0.008) << radius_m << " " << tilt_rad;
    }
  }
}

TEST(BrunetMdh, StaysWithinTwoCentimetresUnderNoise) {
  std::cout << "seed " << kSeed << "\n";
  PluginUnderTest plugin(kId), firm(kId, "{yield_tension: 0}");
  double sum_m = 0.0, firm_sum_m = 0.0;
  int runs = 0;
  for (const double radius_m : {0.25, -0.25, 0.12, -0.12}) {
    for (const double tilt_rad : {-0.4, 0.0, 0.4}) {
      Scene scene = Scene::bent(radius_m, {0.6, 0.0, 0.0, 0.2, tilt_rad, 0.0});
      scene.look(0.5, kSeed + static_cast<std::uint64_t>(runs++));
      const double error_m = scene.mean_error_m(solved(scene.run(plugin)));
      EXPECT_LT(error_m, 0.012) << radius_m << " " << tilt_rad;
      sum_m += error_m;
      firm_sum_m += scene.mean_error_m(solved(scene.run(firm)));
    }
  }
  std::cout << "mean error " << 1e3 * sum_m / runs << " mm, with firm distances "
            << 1e3 * firm_sum_m / runs << " mm\n";
  EXPECT_LT(sum_m, 0.7 * firm_sum_m);
}

TEST(BrunetMdh, BeginsWithTheConstantsOfItsPreset) {
  std::cout << "seed " << kSeed << "\n";
  Scene scene = Scene::bent(0.25);
  scene.look(0.5, kSeed);
  const auto vertices_m = [&](const std::string& params) {
    PluginUnderTest plugin(kId, params);
    return Points3(solved(scene.run(plugin)).vertices_m.matrix<3>());
  };
  const std::string common = "tolerance_m: 1.0e-5, max_iterations: 5000, rings: 2, ";
  const Points3 author_m = vertices_m("{preset: author}"), weft_m = vertices_m("{}");
  EXPECT_EQ(weft_m, vertices_m("{preset: weft}"));
  EXPECT_EQ(weft_m, vertices_m("{" + common + "yield_tension: 8, preset: author}"));
  EXPECT_EQ(author_m, vertices_m("{" + common + "yield_tension: 0, preset: weft}"));
  EXPECT_NE(author_m, weft_m);
}

TEST(BrunetMdh, AWrongRayDoesNotPullTheSheetToTheCamera) {
  Scene scene = Scene::bent(0.25);
  scene.aim(33, scene.lines.pixel_px.matrix<2>().row(33).transpose() + Eigen::Vector2d(60, -40));
  PluginUnderTest plugin(kId), firm(kId, "{yield_tension: 0}");
  const Shape shape = solved(scene.run(plugin));
  EXPECT_LT(scene.mean_error_m(shape), 0.02);
  EXPECT_GT(shape.diag.value("yielding_distances", 0.0), 0.0);
  EXPECT_GT(scene.mean_error_m(solved(scene.run(firm))), 0.1);
  const Array<double>* suspicion = shape.diag.find("suspicion");
  ASSERT_NE(suspicion, nullptr);
  const double* first = suspicion->data();
  EXPECT_EQ(std::max_element(first, first + 60) - first, 33);
}

TEST(BrunetMdh, KnownPointsBoundTheDepthAroundThem) {
  std::cout << "seed " << kSeed << "\n";
  PluginUnderTest plugin(kId), firm(kId, "{yield_tension: 0}");
  double with_m = 0.0, without_m = 0.0;
  std::uint64_t seed = kSeed;
  for (const double radius_m : {0.25, -0.25, 0.12, -0.12}) {
    Scene scene = Scene::bent(radius_m, {0.6, 0.0, 0.0, 0.2, 0.3, 0.0});
    const KnownPoints known = scene.known({20, 29, 34}, 0.001);
    const Shape exact = solved(scene.run(firm, &known));
    for (const std::int32_t v : {20, 29, 34}) {
      EXPECT_LT((exact.vertices_m.matrix<3>().row(v) - scene.truth_m.row(v)).norm(), 0.0015) << v;
    }
    scene.look(0.5, seed++);
    with_m += scene.mean_error_m(solved(scene.run(plugin, &known)));
    without_m += scene.mean_error_m(solved(scene.run(plugin)));
  }
  std::cout << "with " << 250.0 * with_m << " mm, without " << 250.0 * without_m << " mm\n";
  EXPECT_LT(with_m, 0.8 * without_m);
}

TEST(BrunetMdh, AKnownPointHoldsAVertexThatIsNotSeen) {
  Scene scene = Scene::bent(0.25);
  scene.seen.clear();
  for (std::int32_t v = 0; v < 60; ++v) {
    if (v % 10 < 6) scene.seen.push_back(v);
  }
  scene.look();
  PluginUnderTest plugin(kId);
  const KnownPoints known = scene.known({9, 59}, 0.0);
  const Shape with = solved(scene.run(plugin, &known)), without = solved(scene.run(plugin));
  EXPECT_LT((with.vertices_m.matrix<3>().row(59) - scene.truth_m.row(59)).norm(), 1e-12);
  EXPECT_EQ(with.source(59), 1);
  EXPECT_EQ(without.source(59), 0);
  EXPECT_EQ(with.diag.value("known_points", 0.0), 2.0);
  EXPECT_LT(scene.mean_error_m(with), 0.7 * scene.mean_error_m(without));
}

TEST(BrunetMdh, AKnownPointFarFromItsRayBoundsItsDepthAlone) {
  const Scene scene = Scene::bent(0.25);
  const KnownPoints known = scene.known({33}, 0.0, {0.03, 0.0, 0.0});
  for (const char* params : {"{}", "{yield_tension: 0}"}) {
    PluginUnderTest plugin(kId, params);
    const Shape shape = solved(scene.run(plugin, &known));
    EXPECT_LT(scene.mean_error_m(shape), 0.01) << params;
  }
}

TEST(BrunetMdh, AKnownPointThatIsNoneIsAnError) {
  const Scene scene = Scene::bent(0.25);
  PluginUnderTest plugin(kId);
  KnownPoints known = scene.known({3, 4}, 0.01);
  known.vertex(1) = 60;
  EXPECT_THAT(scene.run(plugin, &known).message,
              ::testing::HasSubstr("known point 1 names vertex"));
  known = scene.known({3, 4}, 0.01);
  known.points_m(0, 0) = std::nan("");
  EXPECT_EQ(scene.run(plugin, &known).status, WEFT_ERROR);
}

TEST(BrunetMdh, VerticesWithoutARayAreFilledIn) {
  Scene scene = Scene::bent(0.25);
  scene.seen.clear();
  for (std::int32_t v = 0; v < 60; ++v) {
    if (v % 10 < 6 && v != 22 && v != 23) scene.seen.push_back(v);
  }
  scene.look();
  PluginUnderTest plugin(kId);
  const Shape shape = solved(scene.run(plugin));
  for (std::int32_t v = 0; v < 60; ++v) {
    const bool seen = std::count(scene.seen.begin(), scene.seen.end(), v) > 0;
    EXPECT_EQ(shape.source(v), seen ? 1 : 0) << v;
  }
  const Points3 vertices_m = shape.vertices_m.matrix<3>();
  EXPECT_LT((vertices_m.row(22) - scene.truth_m.row(22)).norm(), 0.006);
  EXPECT_LT(scene.mean_error_m(shape), 0.03);
}

TEST(BrunetMdh, JoinsPatchesThatDoNotTouch) {
  Scene scene = Scene::bent(0.25);
  scene.seen = {0, 1, 2, 10, 11, 12, 47, 48, 49, 57, 58, 59};
  scene.look();
  PluginUnderTest plugin(kId);
  const Shape shape = solved(scene.run(plugin));
  EXPECT_EQ(shape.diag.value("points", 0.0), 12.0);
  EXPECT_LT(scene.mean_error_m(shape), 0.03);
}

TEST(BrunetMdh, TakesPointsInsideFaces) {
  Scene scene = Scene::bent(0.25);
  look_at_faces(scene, 0.1);
  PluginUnderTest plugin(kId);
  const Shape shape = solved(scene.run(plugin));
  EXPECT_EQ(shape.diag.value("points", 0.0), 90.0);
  EXPECT_LT(scene.mean_error_m(shape), 0.004);
}

TEST(BrunetMdh, RepeatedSightlinesOfAVertexCountOnce) {
  Scene scene = Scene::bent(0.25);
  PluginUnderTest plugin(kId);
  const Shape once = solved(scene.run(plugin));
  scene.seen.push_back(7);
  scene.look();
  scene.aim(60, {0.0, 0.0});
  const Shape twice = solved(scene.run(plugin));
  EXPECT_EQ(twice.vertices_m.matrix<3>(), once.vertices_m.matrix<3>());
}

TEST(BrunetMdh, GrowsWithTheTemplate) {
  Scene scene = Scene::bent(0.12);
  PluginUnderTest plugin(kId), tenfold(kId, "{tolerance_m: 1e-4}");
  const Points3 small_m = solved(scene.run(plugin)).vertices_m.matrix<3>();
  scene.templ.vertices_m.matrix<3>() *= 10.0;
  const Points3 large_m = solved(scene.run(tenfold)).vertices_m.matrix<3>();
  EXPECT_LT((0.1 * large_m - small_m).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(BrunetMdh, FreshAndUsedInstancesAgreeExactly) {
  Scene first = Scene::bent(0.12), second = Scene::bent(-0.25);
  second.seen.resize(41);
  second.look(0.5, kSeed);
  first.templ.revision = second.templ.revision = 7;
  PluginUnderTest used(kId), fresh(kId);
  const Points3 before = solved(first.run(used)).vertices_m.matrix<3>();
  solved(second.run(used));
  EXPECT_EQ(Points3(solved(first.run(used)).vertices_m.matrix<3>()), before);
  EXPECT_EQ(Points3(solved(second.run(used)).vertices_m.matrix<3>()),
            Points3(solved(second.run(fresh)).vertices_m.matrix<3>()));
}

TEST(BrunetMdh, ANewTemplateReplacesTheCache) {
  Scene scene = Scene::bent(0.25);
  scene.templ.revision = 7;
  PluginUnderTest plugin(kId);
  const double small_m = solved(scene.run(plugin)).vertices_m(0, 2);
  scene.templ.vertices_m.matrix<3>() *= 2.0;
  scene.templ.revision = 8;
  EXPECT_NEAR(solved(scene.run(plugin)).vertices_m(0, 2), 2.0 * small_m, 1e-3);
}

TEST(BrunetMdh, AnUnfinishedIterationIsFlagged) {
  const Scene scene = Scene::bent(0.25);
  PluginUnderTest plugin(kId, "{max_iterations: 3}");
  const PluginAnswer out = scene.run(plugin);
  EXPECT_EQ(out.status, WEFT_DEGENERATE);
  EXPECT_THAT(out.message, ::testing::HasSubstr("max_iterations"));
  EXPECT_EQ(out.get<Shape>().value().shape_state(), ShapeState::weak);
}

TEST(BrunetMdh, DistancesThatYieldAltogetherAreReplacedByFirmOnes) {
  const Scene scene = Scene::bent(0.25);
  PluginUnderTest plugin(kId, "{yield_tension: 0.01}");
  EXPECT_LT(scene.mean_error_m(solved(scene.run(plugin))), 0.01);
}

TEST(BrunetMdh, TwoSightlinesAreNoResult) {
  Scene scene = Scene::bent(0.25);
  scene.seen = {3, 17};
  scene.look();
  PluginUnderTest plugin(kId);
  EXPECT_EQ(scene.run(plugin).status, WEFT_NO_RESULT);
  scene.seen.clear();
  scene.look();
  EXPECT_EQ(scene.run(plugin).status, WEFT_NO_RESULT);
}

TEST(BrunetMdh, SightlinesOnALineAreNoResult) {
  Scene scene = Scene::bent(1e6);
  scene.seen = {20, 21, 22, 23};
  scene.look();
  PluginUnderTest plugin(kId);
  EXPECT_EQ(scene.run(plugin).status, WEFT_NO_RESULT);
}

TEST(BrunetMdh, RaysThatCoincideAreNoResult) {
  Scene scene = Scene::bent(0.25);
  for (std::int64_t i = 0; i < 60; ++i) scene.aim(i, {300.0, 200.0});
  PluginUnderTest plugin(kId);
  const PluginAnswer out = scene.run(plugin);
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  EXPECT_THAT(out.message, ::testing::HasSubstr("coincide"));
}

TEST(BrunetMdh, SightlinesOfAnotherTemplateAreAnError) {
  Scene scene = Scene::bent(0.25);
  scene.lines.vertex(5) = 60;
  PluginUnderTest plugin(kId);
  const PluginAnswer out = scene.run(plugin);
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_THAT(out.message, ::testing::HasSubstr("sightline 5"));
}

TEST(BrunetMdh, SightlinesThatAreNoRaysAreAnError) {
  Scene scene = Scene::bent(0.25);
  scene.lines.ray(7, 1) = std::nan("");
  PluginUnderTest plugin(kId);
  EXPECT_THAT(scene.run(plugin).message, ::testing::HasSubstr("sightline 7 has no unit ray"));
  scene.lines.ray.matrix<3>().row(7).setZero();
  EXPECT_EQ(scene.run(plugin).status, WEFT_ERROR);
}

TEST(BrunetMdh, TwoVerticesOnOneRayAreNoObstacle) {
  Scene scene = Scene::bent(0.25);
  scene.aim(34, scene.lines.pixel_px.matrix<2>().row(33).transpose());
  PluginUnderTest plugin(kId);
  EXPECT_LT(scene.mean_error_m(solved(scene.run(plugin))), 0.02);
}

TEST(BrunetMdh, APointThatComesToLieBehindTheCameraIsFlagged) {
  Scene scene = Scene::bent(0.25);
  scene.lines.ray.matrix<3>().row(33) *= -1.0;
  PluginUnderTest plugin(kId, "{yield_tension: 0}");
  const PluginAnswer out = scene.run(plugin);
  EXPECT_EQ(out.status, WEFT_DEGENERATE);
  EXPECT_THAT(out.message, ::testing::HasSubstr("behind the camera"));
  const Shape shape = out.get<Shape>().value();
  EXPECT_EQ(shape.shape_state(), ShapeState::weak);
  EXPECT_EQ(shape.vertices_m.matrix<3>().row(33).norm(), 0.0);
}

TEST(BrunetMdh, ATemplateThatIsNotFiniteIsAnError) {
  Scene scene = Scene::bent(0.25);
  scene.templ.vertices_m(3, 2) = std::nan("");
  PluginUnderTest plugin(kId);
  const PluginAnswer out = scene.run(plugin);
  EXPECT_EQ(out.status, WEFT_ERROR);
  EXPECT_THAT(out.message, ::testing::HasSubstr("finite"));
}

TEST(BrunetMdh, PartsThatTheSurfaceDoesNotJoinAreDroppedButForTheLargest) {
  Scene scene = Scene::bent(0.25);
  scene.templ.vertices_m = make_array<double>(scene.truth_m);  // no longer flat
  const Faces all = scene.templ.faces.matrix<3>();
  std::vector<Eigen::Index> left;
  for (Eigen::Index f = 0; f < all.rows(); ++f) {
    const auto columns = (all.row(f).array() - 10 * (all.row(f).array() / 10)).eval();
    if (columns.minCoeff() != 6) left.push_back(f);  // the column of cells from 6 to 7
  }
  scene.templ.faces = make_array<std::int32_t>(Faces(all(left, Eigen::all)));
  PluginUnderTest plugin(kId);
  const Shape shape = scene.run(plugin).get<Shape>().value();
  EXPECT_EQ(shape.diag.value("points", 0.0), 42.0);
  EXPECT_EQ(shape.diag.value("dropped_points", 0.0), 18.0);
  EXPECT_TRUE(shape.vertices_m.matrix<3>().allFinite());
}

}  // namespace
}  // namespace weft::brunet_mdh
