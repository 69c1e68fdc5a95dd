// SPDX-License-Identifier: Apache-2.0
#include "common/agreement.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <weft/core/rng.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::solvers {
namespace {

constexpr std::uint64_t kSeed = 20261121;

/// A bent sheet, and places on it that are seen where they are.
struct Scene {
  Template templ = testing::make_template();
  Pinhole camera = testing::pinhole(testing::make_camera());
  Faces faces = templ.faces.matrix<3>();
  Points3 vertices_m = testing::bent_vertices(
      templ, testing::make_cylinder({}, 0.25, 0.3, {0.6, 0.0, 0.0, 0.2, -0.1, 0.0}));
  Correspondences matches;

  explicit Scene(std::int64_t count) {
    std::cout << "seed " << kSeed << "\n";
    Rng rng(kSeed);
    matches.template_px = Array<double>({count, 2});
    matches.image_px = Array<double>({count, 2});
    matches.face = Array<std::int32_t>({count});
    matches.barycentrics = Array<double>({count, 3});
    matches.kept = Array<std::uint8_t>({count});
    matches.score = Array<double>({count});
    for (std::int64_t i = 0; i < count; ++i) {
      const double a = rng.uniform(0.0, 0.5), b = rng.uniform(0.0, 0.5);
      const Eigen::Vector3d weights(a, b, 1.0 - a - b);
      matches.face(i) = static_cast<std::int32_t>(i % faces.rows());
      matches.barycentrics.matrix<3>().row(i) = weights.transpose();
      see(i, interpolate(vertices_m, faces, matches.face(i), weights));
      matches.kept(i) = 1;
    }
  }

  void see(std::int64_t i, const Eigen::Vector3d& place_m) {
    matches.image_px.matrix<2>().row(i) = project(camera, place_m).transpose();
  }
};

TEST(Agreement, CountsKeptMatchesWithinThreePixels) {
  Scene scene(40);
  scene.matches.kept(0) = 0;
  scene.matches.image_px(1, 0) += 2.9;
  scene.matches.image_px(2, 0) += 3.1;
  const Agreement found = agreement(scene.matches, scene.faces, scene.camera, scene.vertices_m);
  EXPECT_EQ(found.kept, 39);
  EXPECT_EQ(found.agreeing, 38);
}

TEST(Agreement, HasNoMatchOutsideTheTemplateOrBehindTheCamera) {
  Scene scene(10);
  scene.matches.face(3) = -1;
  EXPECT_EQ(agreement(scene.matches, scene.faces, scene.camera, scene.vertices_m).agreeing, 9);
  const Points3 behind_m = -scene.vertices_m;
  EXPECT_EQ(agreement(scene.matches, scene.faces, scene.camera, behind_m).agreeing, 0);
}

TEST(Agreement, CountsSightlinesAtVerticesAndInFaces) {
  const Scene scene(3);
  Sightlines lines;
  lines.vertex = Array<std::int32_t>({3});
  lines.face = Array<std::int32_t>({3});
  lines.barycentrics = scene.matches.barycentrics;
  lines.pixel_px = Array<double>({3, 2});
  lines.weight = Array<double>({3});
  for (std::int64_t i = 0; i < 3; ++i) {
    lines.vertex(i) = -1;
    lines.face(i) = scene.matches.face(i);
    lines.weight(i) = i == 2 ? 0.0 : 0.5;
    lines.pixel_px.matrix<2>().row(i) = scene.matches.image_px.matrix<2>().row(i);
  }
  lines.vertex(1) = 7;  // seen where a place in a face is, far from the vertex
  const Agreement found = agreement(lines, scene.faces, scene.camera, scene.vertices_m);
  EXPECT_EQ(found.kept, 2);
  EXPECT_EQ(found.agreeing, 1);
  lines.pixel_px.matrix<2>().row(1) =
      project(scene.camera, scene.vertices_m.row(7).transpose()).transpose();
  EXPECT_EQ(agreement(lines, scene.faces, scene.camera, scene.vertices_m).agreeing, 2);
}

TEST(ConfidenceOfFilters, IsOneUnlessAFilterSaidLess) {
  EXPECT_EQ(confidence_of_filters(std::nullopt), 1.0);
  Correspondences matches = Scene(1).matches;
  EXPECT_EQ(confidence_of_filters(matches), 1.0);
  matches.confidence = make_scalar(0.3);
  EXPECT_EQ(confidence_of_filters(matches), 0.3);
}

}  // namespace
}  // namespace weft::solvers
