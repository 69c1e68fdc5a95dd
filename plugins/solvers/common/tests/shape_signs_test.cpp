// SPDX-License-Identifier: Apache-2.0
#include "common/shape_signs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::solvers {
namespace {

constexpr ConfidenceWeights kSignWeights{.bias = -2.0,
                                         .strain = -1.0,
                                         .strain_p95 = -0.5,
                                         .residual = -1.0,
                                         .roughness = -0.5,
                                         .size = 0.3,
                                         .agreeing = 0.5,
                                         .share = 0.2,
                                         .coverage = 1.0};

/// A surface on a cylinder of 0.2 m, and matches on its mesh.
struct SignScene {
  Template templ = testing::make_template();
  Camera camera = testing::make_camera();
  Points3 truth_m = testing::bent_vertices(templ, testing::make_cylinder({}, 0.2, 0.3));
  Correspondences matches;
  std::vector<DistanceConstraint> edges;
  weft_call raw{};

  explicit SignScene(testing::MatchSpec spec = {.count = 200}) {
    Rng rng(41);
    matches = testing::draw_matches(templ, camera, truth_m, spec, rng).matches;
    const auto topology = build_topology(templ.faces.matrix<3>(), templ.vertices_m.rows());
    edges = *distance_constraints(topology->edges, templ.vertices_m.matrix<3>());
  }
  SolverInput input() const {
    SolverInput in{Call(raw)};
    in.templ = templ;
    in.camera = camera;
    in.correspondences = matches;
    return in;
  }
  ShapeSigns of(const Points3& vertices_m) const { return shape_signs(input(), edges, vertices_m); }
  double confidence_of(const Points3& vertices_m) const {
    return confidence(of(vertices_m), kSignWeights, matches);
  }
};

TEST(ShapeSigns, TheTrueShapeMeetsItsMatchesAndKeepsItsLengths) {
  const SignScene scene;
  const ShapeSigns signs = scene.of(scene.truth_m);
  EXPECT_LT(signs.residual_px, 1e-9);
  EXPECT_LT(signs.strain_p95, 0.002);  // chords of a cylinder
  EXPECT_EQ(signs.evidence.agreeing, 200);
  EXPECT_EQ(signs.evidence.kept, 200);
}

TEST(ShapeSigns, AShapeThatIsScaledFromTheCameraHasTheScaleAsItsStrain) {
  const SignScene scene;
  const Points3 further_m = 1.1 * scene.truth_m;
  const ShapeSigns near = scene.of(scene.truth_m), far = scene.of(further_m);
  EXPECT_NEAR(far.strain, 0.1, 0.002);
  EXPECT_NEAR(far.residual_px, near.residual_px, 1e-9);
  EXPECT_NEAR(far.size_px, near.size_px, 1e-9);
  EXPECT_NEAR(far.roughness_rad, near.roughness_rad, 1e-9);
}

TEST(ShapeSigns, TheResidualIsTheMedianDistanceOfWhatFiltersKept) {
  SignScene scene;
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    scene.matches.image_px(i, 0) += i < 80 ? 3.0 : 50.0;
    scene.matches.kept(i) = i < 150 ? 1 : 0;
  }
  EXPECT_NEAR(scene.of(scene.truth_m).residual_px, 3.0, 1e-9);
}

TEST(ShapeSigns, ThereIsNoRoughnessOnAFlatSheetAndOneRaisedVertexMakesSome) {
  const SignScene scene;
  Points3 flat_m = testing::bent_vertices(scene.templ, testing::make_cylinder({}, 1e9, 0.0));
  EXPECT_LT(scene.of(flat_m).roughness_rad, 1e-6);
  flat_m(23, 2) -= 0.01;
  EXPECT_GT(scene.of(flat_m).roughness_rad, 0.01);
}

TEST(Confidence, IsTheLogisticOfTheWeighedLogarithms) {
  const SignScene scene;
  const ShapeSigns signs{.strain = 0.009,
                         .strain_p95 = 0.019,
                         .residual_px = 0.9,
                         .roughness_rad = 0.09,
                         .size_px = 299.0,
                         .evidence = {.kept = 99, .agreeing = 49, .coverage = 0.45}};
  const double logit = -2.0 - std::log(0.01) - 0.5 * std::log(0.02) - std::log(1.0) -
                       0.5 * std::log(0.1) + 0.3 * std::log(300.0) + 0.5 * std::log(50.0) +
                       0.2 * std::log(0.5) + std::log(0.5);
  EXPECT_NEAR(confidence(signs, kSignWeights, scene.matches), 1.0 / (1.0 + std::exp(-logit)),
              1e-12);
}

TEST(Confidence, FallsWithWrongLengthsWithNoiseAndWithFewerMatches) {
  const SignScene scene, noisy({.count = 200, .noise_px = 3.0}), few({.count = 20});
  const double best = scene.confidence_of(scene.truth_m);
  const Points3 further_m = 1.1 * scene.truth_m;
  EXPECT_LT(scene.confidence_of(further_m), best);
  EXPECT_LT(noisy.confidence_of(noisy.truth_m), best);
  EXPECT_LT(few.confidence_of(few.truth_m), best);
}

TEST(Confidence, IsNoneWithoutAMatchThatCounts) {
  SignScene scene;
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) scene.matches.kept(i) = 0;
  EXPECT_EQ(scene.confidence_of(scene.truth_m), 0.0);
}

TEST(Confidence, IsMultipliedByWhatFiltersSaid) {
  SignScene scene;
  const double alone = scene.confidence_of(scene.truth_m);
  scene.matches.confidence = make_scalar(0.4);
  EXPECT_DOUBLE_EQ(scene.confidence_of(scene.truth_m), 0.4 * alone);
}

}  // namespace
}  // namespace weft::solvers
