// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <weft/data/matrix.hpp>
#include <weft/geometry/known_surface.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft {
namespace {

using ::testing::HasSubstr;

/// One known point, at a place of the template if the vertex is -1.
KnownPoints one_point(std::int32_t vertex, const Eigen::RowVector2d& xy_m = {0.0, 0.0}) {
  KnownPoints known{Array<std::int32_t>({1}, 0), Array<double>({1, 3}, 0.0),
                    Array<double>({1}, 0.0), Array<double>({1, 2}, 0.0)};
  known.vertex(0) = vertex;
  known.points_m(0, 2) = 0.6;
  known.radius_m(0) = 0.002;
  known.template_xy_m.matrix<2>().row(0) = xy_m;
  return known;
}

std::string mistake_in(const KnownPoints& known, const Template& templ) {
  const auto points = known_surface_points(known, templ, 0.005);
  return points ? "accepted" : points.error().message;
}

TEST(KnownSurface, APlaceOnTheTemplateIsThatPlaceOnAnyShape) {
  const Template templ = testing::make_template();
  const auto sheet = testing::make_cylinder({}, 0.25, 0.3);
  const Points3 flat_m = templ.vertices_m.matrix<3>();
  const Points3 bent_m = testing::bent_vertices(templ, sheet);
  for (const double x_m : {0.0, 0.0414, 0.1, 0.29}) {
    for (const double y_m : {0.0, 0.03, 0.17}) {
      const auto points = known_surface_points(one_point(-1, {x_m, y_m}), templ, 0.005);
      ASSERT_TRUE(points) << points.error().message;
      const Eigen::Vector3d flat = points->front().on(flat_m);
      EXPECT_NEAR(flat.x(), x_m, 1e-9);
      EXPECT_NEAR(flat.y(), y_m, 1e-9);
      // A face is a chord of the surface: a diagonal of 47 mm is 1.1 mm from a radius of 250 mm.
      EXPECT_LT((points->front().on(bent_m) - sheet.at(x_m, y_m)).norm(), 0.0015);
    }
  }
}

TEST(KnownSurface, APlaceAtAVertexIsTheVertex) {
  const Template templ = testing::make_template();
  for (const std::int32_t v : {0, 9, 27, 59}) {
    const Eigen::RowVector2d xy_m = templ.vertices_m.matrix<3>().row(v).head<2>();
    const auto points = known_surface_points(one_point(-1, xy_m), templ, 0.005);
    ASSERT_TRUE(points) << points.error().message;
    EXPECT_EQ(points->front().vertex, v);
    EXPECT_EQ(points->front().weights[0], 1.0);
  }
}

TEST(KnownSurface, ARadiusBelowZeroIsTheSolversOwn) {
  const Template templ = testing::make_template();
  KnownPoints known = one_point(3);
  EXPECT_EQ(known_surface_points(known, templ, 0.005)->front().radius_m, 0.002);
  known.radius_m(0) = -1.0;
  EXPECT_EQ(known_surface_points(known, templ, 0.005)->front().radius_m, 0.005);
}

TEST(KnownSurface, WhatIsNoPointOfTheSurfaceIsNamed) {
  Template templ = testing::make_template();
  EXPECT_THAT(mistake_in(one_point(60), templ), HasSubstr("known point 0 names vertex 60"));
  EXPECT_THAT(mistake_in(one_point(-2), templ), HasSubstr("names vertex -2"));
  EXPECT_EQ(mistake_in(one_point(-1, {-0.002, 0.05}), templ), "accepted");
  EXPECT_THAT(mistake_in(one_point(-1, {-0.05, 0.05}), templ),
              HasSubstr("is at (-50.000000, 50.000000) mm, beside the template"));
  KnownPoints nowhere = one_point(-1);
  nowhere.template_xy_m = {};
  EXPECT_THAT(mistake_in(nowhere, templ), HasSubstr("names vertex -1"));
  KnownPoints open = one_point(3);
  open.points_m(0, 1) = std::nan("");
  EXPECT_THAT(mistake_in(open, templ), HasSubstr("not finite"));
  templ.m_per_px = {};
  EXPECT_THAT(mistake_in(one_point(-1), templ), HasSubstr("not flat: name a vertex"));
}

/// One known point in a face, without a place in the plane of the template.
KnownPoints one_point_in_face(std::int32_t face, const Eigen::RowVector3d& weights) {
  KnownPoints known = one_point(-1);
  known.template_xy_m = {};
  known.face = Array<std::int32_t>({1}, face);
  known.barycentrics = make_array<double>(weights);
  return known;
}

TEST(KnownSurface, APointInAFaceIsThatPointOnAnyShape) {
  Template templ = testing::make_template();
  templ.m_per_px = {};  // a face needs no plane
  const Points3 bent_m = testing::bent_vertices(templ, testing::make_cylinder({}, 0.25, 0.3));
  const auto points = known_surface_points(one_point_in_face(5, {0.2, 0.5, 0.3}), templ, 0.005);
  ASSERT_TRUE(points) << points.error().message;
  const auto faces = templ.faces.matrix<3>();
  const Eigen::RowVector3d expected_m =
      0.2 * bent_m.row(faces(5, 0)) + 0.5 * bent_m.row(faces(5, 1)) + 0.3 * bent_m.row(faces(5, 2));
  EXPECT_EQ(points->front().face, 5);
  EXPECT_LT((points->front().on(bent_m).transpose() - expected_m).norm(), 1e-15);
  const auto corner = known_surface_points(one_point_in_face(5, {0.0, 1.0, 0.0}), templ, 0.005);
  ASSERT_TRUE(corner);
  EXPECT_EQ(corner->front().vertex, faces(5, 1));
}

TEST(KnownSurface, AFaceReplacesThePlaceInThePlane) {
  const Template templ = testing::make_template();
  KnownPoints known = one_point_in_face(5, {0.2, 0.5, 0.3});
  known.template_xy_m = Array<double>({1, 2}, 1e6);
  const auto points = known_surface_points(known, templ, 0.005);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_EQ(points->front().face, 5);
  known.face(0) = -1;
  EXPECT_THAT(mistake_in(known, templ), HasSubstr("beside the template"));
}

TEST(KnownSurface, MistakesInAFaceHaveTheirPoint) {
  const Template templ = testing::make_template();
  const auto mistake = [&](std::int32_t face, const Eigen::RowVector3d& weights) {
    return mistake_in(one_point_in_face(face, weights), templ);
  };
  EXPECT_THAT(mistake(100000, {0.2, 0.5, 0.3}), HasSubstr("known point 0 names face 100000"));
  EXPECT_THAT(mistake(1, {0.2, 0.5, 0.2}), HasSubstr("sum must be 1"));
  EXPECT_THAT(mistake(1, {2.0, -0.6, -0.4}), HasSubstr("at least -0.5"));
  EXPECT_THAT(mistake(1, {0.2, std::nan(""), 0.3}), HasSubstr("sum must be 1"));
  EXPECT_THAT(mistake(-1, {0.2, 0.5, 0.3}), HasSubstr("names vertex -1"));
  KnownPoints bare = one_point_in_face(1, {0.2, 0.5, 0.3});
  bare.barycentrics = {};
  EXPECT_THAT(mistake_in(bare, templ), HasSubstr("'barycentrics' is absent"));
}

}  // namespace
}  // namespace weft
