// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <weft/data/matrix.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace {

using namespace weft::testing;

TEST(MyPluginTemplate, HasTheAreaOfAPolygonInACircle) {
  PluginUnderTest builder("templates/my_plugin", "{radius_m: 0.1, rings: 3, spokes: 12}");
  const PluginAnswer answer = builder.process(0, {});
  ASSERT_EQ(answer.status, WEFT_OK) << answer.message;
  const auto templ = *answer.get<weft::Template>();
  EXPECT_EQ(templ.vertices_m.rows(), 1 + 3 * 12);
  const auto vertices_m = templ.vertices_m.matrix<3>();
  const auto faces = templ.faces.matrix<3>();
  EXPECT_TRUE(weft::validate_flat_mesh(templ.flat_px.matrix<2>(), faces));
  double area_m2 = 0.0;
  for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
    area_m2 += weft::face_area(vertices_m, faces, f);
  }
  EXPECT_NEAR(area_m2, 0.5 * 12 * 0.1 * 0.1 * std::sin(2.0 * std::numbers::pi / 12), 1e-12);
}

TEST(MyPluginTemplate, KeepsTheScaleOfItsTextureAndMasksItsCorners) {
  PluginUnderTest builder("templates/my_plugin", "{radius_m: 0.1, texture_px: 100}");
  const PluginAnswer answer = builder.process(0, {});
  const auto templ = *answer.get<weft::Template>();
  for (std::int64_t v = 0; v < templ.vertices_m.rows(); ++v) {
    for (int k = 0; k < 2; ++k) {
      EXPECT_NEAR(templ.vertices_m(v, k), templ.m_per_px(k) * templ.flat_px(v, k), 1e-15);
      EXPECT_GE(templ.flat_px(v, k), -1e-9);
      EXPECT_LE(templ.flat_px(v, k), 99.0 + 1e-9);
    }
  }
  EXPECT_EQ(templ.mask(0, 0), 0);
  EXPECT_EQ(templ.mask(50, 50), 1);
}

TEST(MyPluginTemplate, RefusesAnOutlineOfTwoCorners) {
  EXPECT_THROW(PluginUnderTest("templates/my_plugin", "{spokes: 2}"), std::runtime_error);
}

}  // namespace
