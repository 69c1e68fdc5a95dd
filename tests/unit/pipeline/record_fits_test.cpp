// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <utility>
#include <weft/data/matrix.hpp>
#include <weft/testing/synthetic.hpp>

#include "pipeline/execution/checks.hpp"

namespace weft {
namespace {

using ::testing::HasSubstr;

TEST(CheckFits, TakesAShapeThatReachesBehindTheCameraForNoResult) {
  const auto sheet = host::Record::copy_of(testing::make_template({.columns = 3, .rows = 3}));
  const auto camera = host::Record::copy_of(testing::make_camera());
  Shape shape;
  shape.vertices_m = Array<double>({9, 3}, 0.5);
  shape.source = Array<std::uint8_t>({9}, 1);
  EXPECT_TRUE(check_fits(*host::Record::copy_of(shape), *sheet, *camera));
  for (const double z_m : {0.0, -0.25}) {
    shape.vertices_m(7, 2) = z_m;
    const auto fits = check_fits(*host::Record::copy_of(shape), *sheet, *camera);
    ASSERT_FALSE(fits);
    EXPECT_EQ(fits.error().code, Errc::no_result);
    EXPECT_EQ(fits.error().message, "the shape reaches behind the camera: its vertex 7 has Z = " +
                                        std::to_string(z_m) + " m");
  }
}

std::string template_refusal(const Template& templ) {
  const auto legal = check_template(*host::Record::copy_of(templ));
  EXPECT_FALSE(legal);
  return legal ? "" : legal.error().message;
}

/// A flat surface in one large tetrahedron.
Template surface_in_a_tetrahedron() {
  Template templ = testing::make_template({.columns = 3, .rows = 3});
  Eigen::Matrix4d corners;
  corners << -9.0, 9.0, 0.0, 0.0, -9.0, 0.0, 9.0, 0.0, -9.0, 0.0, 0.0, 9.0, 1.0, 1.0, 1.0, 1.0;
  const Eigen::Matrix<double, 4, 3> nodes_m = corners.topRows<3>().transpose();
  templ.nodes_m = make_array<double>(nodes_m);
  templ.tetrahedra = Array<std::int32_t>({1, 4});
  for (std::int32_t k = 0; k < 4; ++k) templ.tetrahedra(0, k) = k;
  templ.vertex_tetrahedron = Array<std::int32_t>({9}, 0);
  templ.vertex_barycentric = Array<double>({9, 4});
  for (std::int64_t v = 0; v < 9; ++v) {
    const Eigen::Vector4d place(templ.vertices_m(v, 0), templ.vertices_m(v, 1),
                                templ.vertices_m(v, 2), 1.0);
    const Eigen::Vector4d weights = corners.inverse() * place;
    for (int k = 0; k < 4; ++k) templ.vertex_barycentric(v, k) = weights(k);
  }
  return templ;
}

TEST(CheckTemplate, TakesASolidTemplate) {
  const auto legal = check_template(*host::Record::copy_of(surface_in_a_tetrahedron()));
  EXPECT_TRUE(legal) << legal.error().message;
}

TEST(CheckTemplate, RefusesTetrahedraThatDoNotBelongToTheSurface) {
  Template moved = surface_in_a_tetrahedron();
  moved.vertices_m(4, 2) += 0.01;
  EXPECT_THAT(template_refusal(moved),
              HasSubstr("vertex_barycentric at index 4 puts the vertex 10.0"));
  Template turned = surface_in_a_tetrahedron();
  std::swap(turned.tetrahedra(0, 0), turned.tetrahedra(0, 1));
  EXPECT_THAT(template_refusal(turned), HasSubstr("tetrahedra at index 0 has a negative volume"));
}

TEST(CheckTemplate, RefusesAWeldingOfDistantVertices) {
  Template templ = testing::make_template({.columns = 3, .rows = 3});
  templ.welded_vertex = Array<std::int32_t>({9});
  for (std::int32_t v = 0; v < 9; ++v) templ.welded_vertex(v) = v;
  EXPECT_TRUE(check_template(*host::Record::copy_of(templ)));
  templ.welded_vertex(8) = 0;
  EXPECT_THAT(template_refusal(templ), HasSubstr("welded_vertex at index 8 is 0"));
}

}  // namespace
}  // namespace weft
