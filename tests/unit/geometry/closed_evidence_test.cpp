// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <functional>
#include <iostream>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/shape_evidence.hpp>
#include <weft/testing/synthetic.hpp>

#include "support/charted_objects.hpp"

namespace weft::closed_evidence_test {
namespace {

constexpr std::uint64_t kSeed = 20261130;

/// An object of several charts 0.6 m in front of the camera, and matches that are exactly at the
/// pixels of their places, hidden or not.
struct Scene {
  Template templ;
  Camera camera = testing::make_camera();
  Faces faces;
  Points3 vertices_m;

  Scene(Template object, const Eigen::Matrix3d& rotation) : templ(std::move(object)) {
    std::cout << "seed " << kSeed << "\n";
    faces = templ.faces.matrix<3>();
    vertices_m = templ.vertices_m.matrix<3>() * rotation.transpose();
    vertices_m.col(2).array() += 0.6;
  }

  bool faces_the_camera(std::int32_t f) const {
    const Eigen::Vector3d a = vertices_m.row(faces(f, 0)), b = vertices_m.row(faces(f, 1)),
                          c = vertices_m.row(faces(f, 2));
    return (b - a).cross(c - a).dot(a) < 0.0;
  }

  /// `count` matches on the chosen faces.
  Correspondences matches(int count, const std::function<bool(std::int32_t)>& chosen) const {
    std::vector<std::int32_t> those;
    for (std::int32_t f = 0; f < faces.rows(); ++f) {
      if (chosen(f)) those.push_back(f);
    }
    Rng rng(kSeed);
    Correspondences made;
    made.template_px = made.image_px = Array<double>({count, 2}, 0.0);
    made.image_px = Array<double>({count, 2}, 0.0);
    made.face = Array<std::int32_t>({count}, 0);
    made.barycentrics = Array<double>({count, 3}, 0.0);
    made.kept = Array<std::uint8_t>({count}, 1);
    for (int i = 0; i < count; ++i) {
      double a = rng.uniform(), b = rng.uniform();
      if (a + b > 1.0) a = 1.0 - a, b = 1.0 - b;
      const Eigen::Vector3d weights(a, b, 1.0 - a - b);
      made.face(i) = those[rng.below(static_cast<std::uint32_t>(those.size()))];
      made.barycentrics.matrix<3>().row(i) = weights.transpose();
      const Eigen::Vector3d place_m = interpolate(vertices_m, faces, made.face(i), weights);
      made.image_px.matrix<2>().row(i) = project(testing::pinhole(camera), place_m).transpose();
    }
    return made;
  }

  ShapeEvidence evidence(const Correspondences& seen) const {
    return EvidenceCount(templ, camera, vertices_m).of(seen);
  }
};

/// A view along a diagonal of the cube: three of its sides face the camera.
Eigen::Matrix3d corner_view() {
  return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d(1.0, 1.0, 1.0),
                                            Eigen::Vector3d(0.0, 0.0, -1.0))
      .toRotationMatrix();
}

TEST(EvidenceOfAClosedObject, CoversAllWhereTheVisibleSidesAreMatched) {
  const Scene scene(charted::charted_cube(9), corner_view());
  const auto seen = scene.evidence(
      scene.matches(2000, [&](std::int32_t f) { return scene.faces_the_camera(f); }));
  EXPECT_EQ(seen.agreeing, 2000);
  EXPECT_GT(seen.coverage, 0.95);
  EXPECT_EQ(state_of(seen, 0.9), ShapeState::estimated);
}

TEST(EvidenceOfAClosedObject, CoversAllWhereTheOnlyVisibleSideIsMatched) {
  const Scene scene(charted::charted_cube(9), Eigen::Matrix3d::Identity());
  const auto seen =
      scene.evidence(scene.matches(500, [&](std::int32_t f) { return scene.faces_the_camera(f); }));
  EXPECT_GT(seen.coverage, 0.95);
}

TEST(EvidenceOfAClosedObject, CoversAThirdWhereOneOfThreeVisibleSidesIsMatched) {
  const Scene scene(charted::charted_cube(9), corner_view());
  const std::int32_t per_side = static_cast<std::int32_t>(scene.faces.rows() / 6);
  std::int32_t side = 0;
  while (!scene.faces_the_camera(side * per_side)) ++side;
  const auto seen =
      scene.evidence(scene.matches(1000, [&](std::int32_t f) { return f / per_side == side; }));
  EXPECT_NEAR(seen.coverage, 1.0 / 3.0, 0.1);
}

TEST(EvidenceOfAClosedObject, IsNotMadeByItsHiddenSides) {
  for (const Template& object : {charted::charted_cube(9), charted::charted_cylinder(16, 9)}) {
    const Scene scene(object, corner_view());
    const auto hidden = scene.evidence(
        scene.matches(2000, [&](std::int32_t f) { return !scene.faces_the_camera(f); }));
    EXPECT_EQ(hidden.kept, 2000);
    EXPECT_EQ(hidden.agreeing, 0);
    EXPECT_EQ(hidden.coverage, 0.0);
    EXPECT_EQ(state_of(hidden, 1.0), ShapeState::weak);
  }
}

TEST(EvidenceOfAClosedObject, DoesNotDependOnTheLayoutOfItsTexture) {
  const Scene scene(charted::charted_cube(9), corner_view());
  const Correspondences matches =
      scene.matches(200, [&](std::int32_t f) { return scene.faces_the_camera(f); });
  Scene shuffled = scene;
  shuffled.templ.flat_px = Array<double>({scene.templ.flat_px.rows(), 2}, 0.0);  // all in one place
  EXPECT_EQ(scene.evidence(matches).coverage, shuffled.evidence(matches).coverage);
  EXPECT_GT(scene.evidence(matches).coverage, 0.25);
}

TEST(EvidenceOfAClosedObject, CountsSightlinesOfFrontVerticesOnly) {
  const Scene scene(charted::charted_cube(9), corner_view());
  const std::int64_t count = scene.vertices_m.rows();
  Sightlines lines;
  lines.vertex = Array<std::int32_t>({count});
  lines.face = Array<std::int32_t>({count}, -1);
  lines.barycentrics = Array<double>({count, 3}, 0.0);
  lines.pixel_px = Array<double>({count, 2});
  lines.weight = Array<double>({count}, 1.0);
  for (std::int64_t v = 0; v < count; ++v) {
    lines.vertex(v) = static_cast<std::int32_t>(v);
    const Eigen::Vector3d place_m = scene.vertices_m.row(v);
    lines.pixel_px.matrix<2>().row(v) =
        project(testing::pinhole(scene.camera), place_m).transpose();
  }
  const auto seen = EvidenceCount(scene.templ, scene.camera, scene.vertices_m).of(lines);
  EXPECT_EQ(seen.kept, 6 * 81);
  EXPECT_EQ(seen.agreeing, 3 * 81);
  EXPECT_EQ(seen.coverage, 1.0);
}

TEST(FacesThatTurnAway, AreThoseOfBoxesAndTubesAndNotOfSheets) {
  EXPECT_TRUE(detail::turns_away(charted::charted_cube(3)));
  EXPECT_TRUE(detail::turns_away(charted::charted_cylinder(8, 3)));
  Template sheet = testing::make_template();
  EXPECT_FALSE(detail::turns_away(sheet));
  // A label: a quarter of a turn on a bottle.
  sheet.vertices_m =
      make_array<double>(testing::bent_vertices(sheet, testing::make_cylinder({}, 0.25, 0.3)));
  EXPECT_FALSE(detail::turns_away(sheet));
}

}  // namespace
}  // namespace weft::closed_evidence_test
