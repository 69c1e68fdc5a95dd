// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <iostream>
#include <limits>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/known_points.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/sightlines.hpp>
#include <weft/data/visibility.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::coarse_to_fine {
namespace {

using testing::input;
using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr const char* kId = "solvers/coarse_to_fine";
constexpr std::uint64_t kSeed = 20261125;

testing::SheetSpec sheet_of(int columns, int rows) {
  testing::SheetSpec spec;
  spec.columns = columns;
  spec.rows = rows;
  return spec;
}

/// A fine mesh of a bent surface, its exact shape and its observations.
struct Scene {
  Template templ;
  Camera camera = testing::make_camera();
  Points3 truth_m;
  Sightlines lines;
  Correspondences matches;

  Scene(const testing::SheetSpec& spec, const DevelopableSheet& sheet, double noise_px = 0.0)
      : templ(testing::make_template(spec)), truth_m(testing::bent_vertices(templ, sheet)) {
    templ.revision = 7;
    Rng rng(kSeed);
    const std::int64_t count = truth_m.rows();
    lines.vertex = Array<std::int32_t>({count});
    lines.face = Array<std::int32_t>({count}, 0);
    lines.barycentrics = Array<double>({count, 3}, 0.0);
    lines.pixel_px = Array<double>({count, 2});
    lines.ray = Array<double>({count, 3});
    lines.weight = Array<double>({count}, 1.0);
    lines.coverage = 1.0;
    for (std::int32_t v = 0; v < count; ++v) {
      Eigen::Vector2d pixel = project(testing::pinhole(camera), truth_m.row(v));
      pixel += noise_px * Eigen::Vector2d(rng.normal(), rng.normal());
      lines.vertex(v) = v;
      lines.barycentrics(v, 0) = 1.0;
      lines.pixel_px.matrix<2>().row(v) = pixel.transpose();
      lines.ray.matrix<3>().row(v) = unit_ray(testing::pinhole(camera), pixel).transpose();
    }
    testing::MatchSpec drawn;
    drawn.count = 600;
    drawn.noise_px = noise_px;
    matches = testing::draw_matches(templ, camera, sheet, drawn, rng).matches;
  }

  std::vector<testing::Input> inputs() const {
    return {input("template", templ), input("camera", camera), input("sightlines", lines),
            input("correspondences", matches)};
  }

  PluginAnswer run(PluginUnderTest& solver, const Shape* previous = nullptr) const {
    auto given = inputs();
    if (previous != nullptr) given.push_back(input("previous.shape", *previous));
    return solver.process(0, given);
  }

  double mean_error_m(const Shape& shape) const {
    return (shape.vertices_m.matrix<3>() - truth_m).rowwise().norm().mean();
  }
};

Shape solved(const PluginAnswer& answer) {
  EXPECT_EQ(answer.status, WEFT_OK) << answer.message;
  return answer.get<Shape>().value();
}

DevelopableSheet cylinder(double radius_m = 0.2) {
  return testing::make_cylinder({}, radius_m, 0.3, {0.6, 0.01, 0.0, 0.2, 0.1, 0.1});
}

DevelopableSheet s_bend() {
  return testing::make_bent_sheet({}, {0.2, 0.0, {{9.0, 0.3, 0.0}}}, {0.6, 0.0, 0.01, 0.1, 0.3, 0});
}

TEST(CoarseToFine, OfParticleSftIsNearlyAsExactColdAndWarmAsAMeshOfAsManyVertices) {
  std::cout << "seed " << kSeed << "\n";
  PluginUnderTest solver(kId, "{vertices: 160}");
  for (const auto& sheet : {cylinder(), s_bend()}) {
    const Scene fine(sheet_of(41, 27), sheet, 0.3);
    const Shape cold = solved(fine.run(solver));
    EXPECT_EQ(cold.vertices_m.rows(), 41 * 27);
    EXPECT_EQ(cold.shape_state(), ShapeState::estimated);
    EXPECT_NEAR(cold.diag.value("coarse_vertices", 0.0), 160.0, 24.0);
    const Shape warm = solved(fine.run(solver, &cold));
    EXPECT_EQ(warm.diag.value("start", -1.0), 0.0);
    PluginUnderTest alone("solvers/particle_sft");
    const Scene coarse(sheet_of(15, 10), sheet, 0.3);
    const double alone_m = coarse.mean_error_m(solved(coarse.run(alone)));
    std::cout << "cold " << 1e3 * fine.mean_error_m(cold) << " mm, warm "
              << 1e3 * fine.mean_error_m(warm) << ", 15 x 10 vertices alone " << 1e3 * alone_m
              << "\n";
    EXPECT_LT(fine.mean_error_m(cold), 1.75 * alone_m);
    EXPECT_LT(fine.mean_error_m(warm), 1.75 * alone_m);
  }
}

TEST(CoarseToFine, OfGaussNewtonMeetsACylinderAndAnSBend) {
  std::cout << "seed " << kSeed << "\n";
  PluginUnderTest solver(kId, "{vertices: 160, solver: {use: solvers/gauss_newton}}");
  for (const auto& sheet : {cylinder(), s_bend()}) {
    const Scene fine(sheet_of(41, 27), sheet);
    const Shape cold = solved(fine.run(solver)), warm = solved(fine.run(solver, &cold));
    std::cout << "cold " << 1e3 * fine.mean_error_m(cold) << " mm, warm "
              << 1e3 * fine.mean_error_m(warm) << "\n";
    EXPECT_LT(fine.mean_error_m(cold), 0.0003);
    EXPECT_LT(fine.mean_error_m(warm), 0.0003);
    ASSERT_TRUE(cold.covariance_m2.present());
    for (std::int64_t v = 0; v < cold.covariance_m2.rows(); ++v) {
      EXPECT_GT(cold.covariance_m2(v, 0), 0.0);
    }
  }
}

TEST(CoarseToFine, ASmallTemplateIsSolvedAsItIs) {
  const Scene small(sheet_of(13, 9), cylinder(), 0.3);
  PluginUnderTest solver(kId, "{vertices: 160}"), alone("solvers/particle_sft");
  const Shape nested = solved(small.run(solver)), same = solved(small.run(alone));
  EXPECT_EQ(nested.vertices_m.matrix<3>(), same.vertices_m.matrix<3>());
  EXPECT_EQ(nested.confidence, same.confidence);
  EXPECT_EQ(nested.diag.entries().size(), same.diag.entries().size());
}

TEST(CoarseToFine, KnowsNothingOfTheFramesBefore) {
  PluginUnderTest used(kId), fresh(kId);
  const Scene first(sheet_of(41, 27), s_bend()), second(sheet_of(41, 27), cylinder());
  const Scene other_mesh(sheet_of(31, 20), s_bend());
  solved(first.run(used));
  Scene renamed = other_mesh;
  renamed.templ.revision = 8;
  solved(renamed.run(used));
  EXPECT_EQ(solved(second.run(used)).vertices_m.matrix<3>(),
            solved(second.run(fresh)).vertices_m.matrix<3>());
}

TEST(CoarseToFine, ServesATemplateThatIsCurvedAtRest) {
  Scene scene(sheet_of(41, 27), cylinder());
  const Points3 rest_m = testing::bent_vertices(
      scene.templ, testing::make_cylinder({}, 0.2, 0.3, {0.0, 0.0, 0.0, 0.0, 0.0, 0.0}));
  scene.templ.vertices_m = make_array<double>(rest_m);
  PluginUnderTest solver(kId);
  const Shape shape = solved(scene.run(solver));
  std::cout << 1e3 * scene.mean_error_m(shape) << " mm\n";
  EXPECT_LT(scene.mean_error_m(shape), 0.003);
}

TEST(CoarseToFine, HandsKnownPointsAndSightlinesInsideFacesOn) {
  const Scene scene(sheet_of(41, 27), cylinder());
  PluginUnderTest solver(kId);
  KnownPoints known;
  known.vertex = Array<std::int32_t>({2});
  known.points_m = Array<double>({2, 3});
  known.radius_m = Array<double>({2}, 0.0);
  for (std::int32_t p = 0; p < 2; ++p) {
    known.vertex(p) = 137 + 600 * p;
    known.points_m.matrix<3>().row(p) = scene.truth_m.row(known.vertex(p));
  }
  auto inputs = scene.inputs();
  inputs.push_back(input("known_points", known));
  EXPECT_LT(scene.mean_error_m(solved(solver.process(0, inputs))), 0.002);

  Scene inside = scene;
  for (std::int64_t i = 0; i < inside.lines.count(); ++i) {
    const std::int32_t v = inside.lines.vertex(i);
    for (std::int32_t f = 0; f < inside.templ.faces.rows(); ++f) {
      for (int k = 0; k < 3; ++k) {
        if (inside.templ.faces(f, k) != v) continue;
        inside.lines.face(i) = f;
        for (int c = 0; c < 3; ++c) inside.lines.barycentrics(i, c) = c == k ? 1.0 : 0.0;
      }
    }
    inside.lines.vertex(i) = -1;
  }
  EXPECT_LT(inside.mean_error_m(solved(inside.run(solver))), 0.004);
}

TEST(CoarseToFine, SaysWhatIsWrongWithItsInputs) {
  Scene scene(sheet_of(41, 27), cylinder());
  PluginUnderTest solver(kId);
  auto inputs = scene.inputs();
  Visibility seen{
      Array<std::uint8_t>({60}, 1), Array<double>({60}, 1.0), Array<std::uint8_t>({60}, 0), {}};
  inputs.push_back(input("visibility", seen));
  EXPECT_EQ(solver.process(0, inputs).status, WEFT_ERROR);

  KnownPoints known;
  known.vertex = Array<std::int32_t>({1}, 5000);
  known.points_m = Array<double>({1, 3}, 1.0);
  known.radius_m = Array<double>({1}, 0.0);
  inputs = scene.inputs();
  inputs.push_back(input("known_points", known));
  const PluginAnswer refused = solver.process(0, inputs);
  EXPECT_EQ(refused.status, WEFT_ERROR);
  EXPECT_NE(refused.message.find("5000"), std::string::npos) << refused.message;

  Scene unseen = scene;
  for (std::int64_t i = 0; i < unseen.lines.count(); ++i) unseen.lines.weight(i) = 0.0;
  EXPECT_EQ(unseen.run(solver).status, WEFT_NO_RESULT);

  scene.templ.vertices_m(7, 2) = std::numeric_limits<double>::quiet_NaN();
  scene.templ.revision = 9;
  EXPECT_EQ(scene.run(solver).status, WEFT_ERROR);
}

}  // namespace
}  // namespace weft::coarse_to_fine
