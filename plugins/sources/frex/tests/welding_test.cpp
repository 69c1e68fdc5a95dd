// SPDX-License-Identifier: Apache-2.0
#include "film/welding.hpp"

#include <gtest/gtest.h>

#include <weft/data/matrix.hpp>

#include "solid/solid_rest.hpp"

namespace weft::frex {
namespace {

/// Two triangles that meet at a seam: vertices 3 and 4 are at the places of 1 and 2.
Template two_charts() {
  Points3 vertices_m(6, 3);
  vertices_m << 0, 0, 0, 0.1, 0, 0, 0, 0.1, 0, 0.1, -0.0, 0, 0, 0.1, 0, 0.1, 0.1, 0.05;
  Points2 flat_px(6, 2);
  flat_px << 0, 0, 10, 0, 0, 10, 50, 0, 40, 10, 50, 10;
  Faces faces(2, 3);
  faces << 0, 2, 1, 3, 4, 5;
  Template templ;
  templ.vertices_m = make_array<double>(vertices_m);
  templ.flat_px = make_array<double>(flat_px);
  templ.faces = make_array<std::int32_t>(faces);
  templ.m_per_px = make_array<double>(Eigen::Vector2d(0.01, 0.01));
  return templ;
}

TEST(Welding, FindsVerticesAtOnePlace) {
  const auto first = first_at_place(two_charts());
  ASSERT_TRUE(first);
  EXPECT_EQ(*first, (std::vector<std::int32_t>{0, 1, 2, 1, 2, 5}));
}

TEST(Welding, TakesTheTwinsOfTheTemplate) {
  Template templ = two_charts();
  templ.welded_vertex = Array<std::int32_t>({6}, 0);
  for (std::int32_t v = 0; v < 6; ++v) templ.welded_vertex(v) = v == 3 ? 1 : v;
  const auto first = first_at_place(templ);
  ASSERT_TRUE(first);
  EXPECT_EQ(*first, (std::vector<std::int32_t>{0, 1, 2, 1, 4, 5}));
  for (const std::int32_t wrong : {-1, 4, 6}) {
    templ.welded_vertex(3) = wrong;
    const auto refused = first_at_place(templ);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_NE(refused.error().message.find("vertex 3"), std::string::npos);
  }
}

TEST(Welding, SpreadsPlacesOverTheirVertices) {
  const Template templ = two_charts();
  const Welding welding(*first_at_place(templ), templ.faces.matrix<3>());
  ASSERT_TRUE(welding.has_seams());
  EXPECT_EQ(welding.kept, (std::vector<std::int32_t>{0, 1, 2, 5}));
  Faces faces(2, 3);
  faces << 0, 2, 1, 1, 2, 3;
  EXPECT_EQ(welding.faces, faces);
  Points3 places_m(4, 3);
  for (int k = 0; k < 4; ++k) places_m.row(k).setConstant(k);
  const Points3 spread_m = welding.spread(places_m);
  EXPECT_EQ(spread_m.col(0).transpose(), (Eigen::RowVectorXd(6) << 0, 1, 2, 1, 2, 3).finished());
}

TEST(SolidRest, DividesBothSidesOfASeamAlike) {
  const auto rest = solid_of(two_charts(), 0.011);
  ASSERT_TRUE(rest) << rest.error().message;
  EXPECT_EQ(rest->surface.truth_points, 6 + 2);
  EXPECT_NEAR(rest->size_m.z(), 0.05, 1e-15);
  // No edge is too long, and every place on the seam has a vertex of each chart.
  const RefinedSurface& surface = rest->surface;
  int on_seam[2] = {0, 0};
  for (Eigen::Index f = 0; f < surface.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = surface.faces(f, k), b = surface.faces(f, (k + 1) % 3);
      EXPECT_LE((surface.places_m.row(a) - surface.places_m.row(b)).norm(), 0.011);
    }
  }
  const Eigen::RowVector3d one = surface.places_m.row(1), other = surface.places_m.row(2);
  for (Eigen::Index v = 0; v < surface.places_m.rows(); ++v) {
    const double beside = (surface.places_m.row(v) - one).norm() +
                          (surface.places_m.row(v) - other).norm() - (one - other).norm();
    if (beside < 1e-12) ++on_seam[surface.uv_px(v, 0) > 20.0 ? 1 : 0];
  }
  EXPECT_GT(on_seam[0], 10);
  EXPECT_EQ(on_seam[0], on_seam[1]);
}

TEST(SolidRest, NeedsTheTexelPitch) {
  Template templ = two_charts();
  templ.m_per_px = {};
  const auto refused = solid_of(templ, 0.0);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("m_per_px"), std::string::npos);
}

}  // namespace
}  // namespace weft::frex
