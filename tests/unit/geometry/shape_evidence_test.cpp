// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <iostream>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/shape_evidence.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::shape_evidence_test {
namespace {

constexpr std::uint64_t kSeed = 20261121;

/// A bent surface, and places on it that are seen at their true positions.
struct Scene {
  testing::SheetSpec spec;
  Template templ = testing::make_template(spec);
  Camera camera = testing::make_camera();
  Faces faces = templ.faces.matrix<3>();
  Points3 vertices_m = testing::bent_vertices(
      templ, testing::make_cylinder(spec, 0.25, 0.3, {0.6, 0.0, 0.0, 0.2, -0.1, 0.0}));
  Correspondences matches;

  explicit Scene(std::int64_t count, testing::SheetSpec sheet = {}) : spec(sheet) {
    std::cout << "seed " << kSeed << "\n";
    Rng rng(kSeed);
    matches.template_px = Array<double>({count, 2}, 0.0);
    matches.image_px = Array<double>({count, 2}, 0.0);
    matches.face = Array<std::int32_t>({count}, 0);
    matches.barycentrics = Array<double>({count, 3}, 0.0);
    matches.kept = Array<std::uint8_t>({count}, 0);
    matches.score = Array<double>({count}, 0.0);
    for (std::int64_t i = 0; i < count; ++i) {
      const double a = rng.uniform(0.0, 0.5), b = rng.uniform(0.0, 0.5);
      const Eigen::Vector3d weights(a, b, 1.0 - a - b);
      matches.face(i) = static_cast<std::int32_t>(i % faces.rows());
      matches.barycentrics.matrix<3>().row(i) = weights.transpose();
      see(i, interpolate(vertices_m, faces, matches.face(i), weights));
      matches.kept(i) = 1;
    }
  }

  Eigen::Vector2d place_px(std::int64_t i) const {
    const Eigen::Vector3d weights = matches.barycentrics.matrix<3>().row(i);
    return interpolate(templ.flat_px.matrix<2>(), faces, matches.face(i), weights);
  }

  template <class Seen>
  ShapeEvidence evidence(const Seen& seen) const {
    return EvidenceCount(templ, camera, vertices_m).of(seen);
  }

  void see(std::int64_t i, const Eigen::Vector3d& place_m) {
    matches.image_px.matrix<2>().row(i) = project(testing::pinhole(camera), place_m).transpose();
  }
};

TEST(ShapeEvidence, CountsKeptMatchesWithinThreePixels) {
  Scene scene(40);
  scene.matches.kept(0) = 0;
  scene.matches.image_px(1, 0) += 2.9;
  scene.matches.image_px(2, 0) += 3.1;
  const ShapeEvidence found = scene.evidence(scene.matches);
  EXPECT_EQ(found.kept, 39);
  EXPECT_EQ(found.agreeing, 38);
}

TEST(ShapeEvidence, HasNoMatchOutsideTheTemplateOrBehindTheCamera) {
  Scene scene(10);
  scene.matches.face(3) = -1;
  EXPECT_EQ(scene.evidence(scene.matches).agreeing, 9);
  scene.vertices_m *= -1.0;
  EXPECT_EQ(scene.evidence(scene.matches).agreeing, 0);
}

TEST(ShapeEvidence, CountsSightlinesAtVerticesAndInFaces) {
  const Scene scene(3);
  Sightlines lines;
  lines.vertex = Array<std::int32_t>({3}, 0);
  lines.face = Array<std::int32_t>({3}, 0);
  lines.barycentrics = scene.matches.barycentrics;
  lines.pixel_px = Array<double>({3, 2}, 0.0);
  lines.weight = Array<double>({3}, 0.0);
  for (std::int64_t i = 0; i < 3; ++i) {
    lines.vertex(i) = -1;
    lines.face(i) = scene.matches.face(i);
    lines.weight(i) = i == 2 ? 0.0 : 0.5;
    lines.pixel_px.matrix<2>().row(i) = scene.matches.image_px.matrix<2>().row(i);
  }
  lines.vertex(1) = 7;  // seen where a place in a face is, far from the vertex
  const ShapeEvidence found = scene.evidence(lines);
  EXPECT_EQ(found.kept, 2);
  EXPECT_EQ(found.agreeing, 1);
  lines.pixel_px.matrix<2>().row(1) =
      project(testing::pinhole(scene.camera), scene.vertices_m.row(7).transpose()).transpose();
  EXPECT_EQ(scene.evidence(lines).agreeing, 2);
}

/// Four matches in each face, on meshes of few and of many vertices.
class CoverageOfMeshes : public ::testing::TestWithParam<int> {
 protected:
  static Scene scene_of(int columns) {
    testing::SheetSpec spec;
    spec.columns = columns;
    spec.rows = columns * 2 / 3;
    return Scene(4 * 2 * (spec.columns - 1) * (spec.rows - 1), spec);
  }
};

TEST_P(CoverageOfMeshes, IsTheShareOfTheSeenTextureNearAgreeingMatches) {
  Scene scene = scene_of(GetParam());
  EXPECT_NEAR(scene.evidence(scene.matches).coverage, 1.0, 0.1);
  const double middle_px = scene.templ.flat_px.matrix<2>().col(0).mean();
  for (std::int64_t i = 0; i < scene.matches.count(); ++i) {
    if (scene.place_px(i).x() > middle_px) scene.matches.image_px(i, 0) += 20.0;
  }
  EXPECT_NEAR(scene.evidence(scene.matches).coverage, 0.5, 0.12);
}

INSTANTIATE_TEST_SUITE_P(Columns, CoverageOfMeshes, ::testing::Values(9, 20, 60));

TEST(ShapeEvidence, CountsNoCoverageWhereTheCameraSeesTheBack) {
  Scene scene(40);
  const double before = scene.evidence(scene.matches).coverage;
  scene.vertices_m.col(0) *= -1.0;  // mirrored: all faces turn away
  for (std::int64_t i = 0; i < 40; ++i) {
    const Eigen::Vector3d weights = scene.matches.barycentrics.matrix<3>().row(i);
    scene.see(i, interpolate(scene.vertices_m, scene.faces, scene.matches.face(i), weights));
  }
  EXPECT_GT(before, 0.25);
  EXPECT_EQ(scene.evidence(scene.matches).agreeing, 40);
  EXPECT_EQ(scene.evidence(scene.matches).coverage, 0.0);
}

TEST(StateOfAShape, IsEstimatedOnlyWhereAllEvidenceSaysSo) {
  const ShapeEvidence good{142, 100, 0.6, 30};
  EXPECT_EQ(state_of(good, 0.9), ShapeState::estimated);
  EXPECT_EQ(state_of(good, 0.49), ShapeState::weak);
  EXPECT_EQ(state_of({142, 3, 0.6, 30}, 0.9), ShapeState::weak);
  EXPECT_EQ(state_of({1000, 100, 0.6, 30}, 0.9), ShapeState::weak);
  EXPECT_EQ(state_of({142, 100, 0.1, 30}, 0.9), ShapeState::weak);
  EXPECT_EQ(state_of({60, 20, 0.6, 8}, 0.9), ShapeState::estimated) << "of sightlines";
  EXPECT_EQ(state_of({6, 6, 0.6, 8}, 0.9), ShapeState::weak) << "of sightlines";
  EXPECT_EQ(state_of({}, 0.9), ShapeState::estimated) << "neither is wired";
  EXPECT_EQ(state_of({}, 0.4), ShapeState::weak) << "neither is wired";
}

TEST(StateOfAShape, SaysWhichCriterionAWeakShapeFails) {
  EXPECT_EQ(why_weak({142, 100, 0.6, 30}, 0.9), "");
  EXPECT_EQ(why_weak({}, 0.9), "");
  EXPECT_EQ(why_weak({40, 12, 0.6, 30}, 0.9),
            "weak: only 12 of 40 matches agree with the shape, 30 are needed");
  EXPECT_EQ(why_weak({1000, 100, 0.6, 30}, 0.9),
            "weak: only 100 of 1000 matches agree with the shape, 250 are needed");
  EXPECT_EQ(why_weak({6, 6, 0.6, 8}, 0.9),
            "weak: only 6 of 6 sightlines agree with the shape, 8 are needed");
  EXPECT_EQ(why_weak({142, 100, 0.1899, 30}, 0.9),
            "weak: the agreeing matches cover 18 % of the visible surface, 25 % are needed");
  EXPECT_EQ(why_weak({142, 100, 0.6, 30}, 0.0449), "weak: confidence 0.04 is below 0.5");
  EXPECT_EQ(why_weak({}, 0.4999), "weak: confidence 0.49 is below 0.5");
  EXPECT_EQ(why_weak({}, std::nan("")), "weak: confidence 0.00 is below 0.5");
}

TEST(StateOfAShape, IsWeakWhereThereIsAReason) {
  Rng rng(kSeed);
  for (int i = 0; i < 1000; ++i) {
    const int kept = static_cast<int>(rng.below(300));
    const ShapeEvidence evidence{kept,
                                 static_cast<int>(rng.below(static_cast<std::uint32_t>(kept) + 1)),
                                 rng.uniform(0.0, 1.0), i % 3 == 0 ? 0 : (i % 3 == 1 ? 8 : 30)};
    const double confidence = rng.uniform(0.0, 1.0);
    EXPECT_EQ(why_weak(evidence, confidence).empty(),
              state_of(evidence, confidence) == ShapeState::estimated);
  }
}

TEST(ConfidenceOfFilters, IsOneUnlessAFilterSaidLess) {
  EXPECT_EQ(confidence_of_filters(std::nullopt), 1.0);
  Correspondences matches = Scene(1).matches;
  EXPECT_EQ(confidence_of_filters(matches), 1.0);
  matches.confidence = make_scalar(0.3);
  EXPECT_EQ(confidence_of_filters(matches), 0.3);
}

}  // namespace
}  // namespace weft::shape_evidence_test
