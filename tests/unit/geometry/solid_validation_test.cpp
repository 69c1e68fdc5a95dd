// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <weft/geometry/solid/validation.hpp>

namespace weft {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A roof of two triangles, cut along its ridge: vertices 3 and 4 are where 1 and 2 are.
Template roof() {
  Points3 vertices_m(6, 3);
  vertices_m << 0.0, 0.0, 0.0, 0.1, 0.0, 0.1, 0.1, 0.1, 0.1, 0.1, 0.0, 0.1, 0.1, 0.1, 0.1, 0.2, 0.1,
      0.0;
  Faces faces(2, 3);
  faces << 0, 1, 2, 3, 5, 4;
  Template templ;
  templ.vertices_m = make_array<double>(vertices_m);
  templ.faces = make_array<std::int32_t>(faces);
  templ.welded_vertex = Array<std::int32_t>({6});
  for (std::int32_t v = 0; v < 6; ++v) templ.welded_vertex(v) = v == 3 ? 1 : v == 4 ? 2 : v;
  return templ;
}

/// The same in two tetrahedra. The second one holds no vertex.
Template solid_roof() {
  Template templ = roof();
  Points3 nodes_m(5, 3);
  nodes_m << -1.0, -1.0, -1.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 2.0;
  Tetrahedra tetrahedra(2, 4);
  tetrahedra << 0, 1, 2, 3, 1, 4, 2, 3;
  templ.nodes_m = make_array<double>(nodes_m);
  templ.tetrahedra = make_array<std::int32_t>(tetrahedra);
  templ.vertex_tetrahedron = Array<std::int32_t>({6}, 0);
  templ.vertex_barycentric = Array<double>({6, 4});
  Eigen::Matrix4d corners;
  for (int k = 0; k < 4; ++k) corners.col(k) << nodes_m.row(k).transpose(), 1.0;
  for (std::int64_t v = 0; v < 6; ++v) {
    const Eigen::Vector4d place(templ.vertices_m(v, 0), templ.vertices_m(v, 1),
                                templ.vertices_m(v, 2), 1.0);
    const Eigen::Vector4d weights = corners.inverse() * place;
    for (int k = 0; k < 4; ++k) templ.vertex_barycentric(v, k) = weights(k);
  }
  return templ;
}

std::string refusal(Template templ, const std::function<void(Template&)>& damage) {
  damage(templ);
  const auto valid = validate_solid(templ);
  EXPECT_FALSE(valid);
  return valid ? "" : valid.error().message;
}

TEST(SolidValidation, TakesTemplatesWithAndWithoutTheOptionalArrays) {
  Template plain = roof();
  EXPECT_TRUE(validate_solid(plain));
  plain.welded_vertex = {};
  EXPECT_TRUE(validate_solid(plain));
  const auto valid = validate_solid(solid_roof());
  EXPECT_TRUE(valid) << valid.error().message;
}

TEST(SolidValidation, NamesTheVertexThatIsWeldedWrongly) {
  const auto welded = [](std::int64_t v, std::int32_t to) {
    return refusal(roof(), [=](Template& templ) { templ.welded_vertex(v) = to; });
  };
  EXPECT_THAT(welded(4, -1), HasSubstr("welded_vertex at index 4 is -1: name the first vertex"));
  EXPECT_THAT(welded(4, 6), HasSubstr("welded_vertex at index 4 is 6"));
  EXPECT_THAT(welded(1, 3), HasSubstr("welded_vertex at index 1 is 3")) << "the first one is named";
  EXPECT_THAT(welded(4, 3), HasSubstr("index 4 is 3, which names vertex 1 itself"));
  EXPECT_THAT(welded(5, 0), AllOf(HasSubstr("index 5 is 0, 223.6"), HasSubstr("mm away")));
  EXPECT_THAT(refusal(roof(), [](Template& templ) { templ.vertices_m(3, 1) += 1e-6; }),
              HasSubstr("weld only vertices at the same place"));
}

TEST(SolidValidation, RefusesAWeldedSurfaceThatIsNotManifold) {
  // A third face at the ridge, with separate vertices.
  Template branched = roof();
  Points3 vertices_m(9, 3);
  vertices_m << branched.vertices_m.matrix<3>(), branched.vertices_m.matrix<3>().topRows(3);
  vertices_m.row(6) << 0.1, 0.0, 0.3;
  Faces faces(3, 3);
  faces << branched.faces.matrix<3>(), 7, 6, 8;
  branched.vertices_m = make_array<double>(vertices_m);
  branched.faces = make_array<std::int32_t>(faces);
  branched.welded_vertex = Array<std::int32_t>({9});
  for (std::int32_t v = 0; v < 9; ++v) branched.welded_vertex(v) = v;
  EXPECT_TRUE(validate_solid(branched));
  for (const auto& [v, first] : {std::pair{3, 1}, {4, 2}, {7, 1}, {8, 2}}) {
    branched.welded_vertex(v) = first;
  }
  EXPECT_THAT(refusal(branched, [](Template&) {}),
              AllOf(HasSubstr("welded_vertex joins vertices so that the edge between"),
                    HasSubstr("more than two faces")));
}

TEST(SolidValidation, NamesTheArrayThatIsMissing) {
  EXPECT_THAT(refusal(solid_roof(), [](Template& templ) { templ.nodes_m = {}; }),
              HasSubstr("has tetrahedra without nodes_m: give all four arrays"));
  EXPECT_THAT(refusal(solid_roof(), [](Template& templ) { templ.vertex_barycentric = {}; }),
              HasSubstr("has nodes_m without vertex_barycentric"));
}

TEST(SolidValidation, NamesTheTetrahedronOrNodeThatIsWrong) {
  EXPECT_THAT(refusal(solid_roof(), [](Template& templ) { templ.tetrahedra(1, 2) = 5; }),
              HasSubstr("tetrahedra at index 1 uses node 5, but there are 5"));
  EXPECT_THAT(refusal(solid_roof(), [](Template& templ) { templ.tetrahedra(1, 2) = -1; }),
              HasSubstr("tetrahedra at index 1 uses node -1"));
  EXPECT_THAT(
      refusal(solid_roof(),
              [](Template& templ) { std::swap(templ.tetrahedra(1, 0), templ.tetrahedra(1, 1)); }),
      HasSubstr("tetrahedra at index 1 has a negative volume: swap two of its nodes"));
  EXPECT_THAT(refusal(solid_roof(), [](Template& templ) { templ.tetrahedra(1, 1) = 2; }),
              HasSubstr("tetrahedra at index 1 has no volume"));
  EXPECT_THAT(refusal(solid_roof(),
                      [](Template& templ) {
                        templ.tetrahedra = Array<std::int32_t>({0, 4});
                      }),
              HasSubstr("tetrahedra are empty"));
  EXPECT_THAT(refusal(solid_roof(),
                      [](Template& templ) {
                        for (int k = 0; k < 4; ++k) templ.tetrahedra(1, k) = templ.tetrahedra(0, k);
                      }),
              HasSubstr("nodes_m at index 4 belongs to no tetrahedron"));
  EXPECT_THAT(refusal(solid_roof(),
                      [](Template& templ) {
                        templ.nodes_m(4, 1) = std::numeric_limits<double>::quiet_NaN();
                      }),
              HasSubstr("nodes_m at index 4 is not finite"));
}

TEST(SolidValidation, NamesTheVertexThatIsEmbeddedWrongly) {
  EXPECT_THAT(refusal(solid_roof(), [](Template& templ) { templ.vertex_tetrahedron(3) = 2; }),
              HasSubstr("vertex_tetrahedron at index 3 is 2, but there are 2 tetrahedra"));
  EXPECT_THAT(refusal(solid_roof(), [](Template& templ) { templ.vertex_tetrahedron(3) = -1; }),
              HasSubstr("vertex_tetrahedron at index 3 is -1"));
  EXPECT_THAT(refusal(solid_roof(), [](Template& templ) { templ.vertex_tetrahedron(3) = 1; }),
              HasSubstr("vertex_barycentric at index 3 puts the vertex"));
  EXPECT_THAT(
      refusal(solid_roof(), [](Template& templ) { templ.vertex_barycentric(2, 0) += 0.01; }),
      HasSubstr("vertex_barycentric at index 2 has the sum 1.01"));
  EXPECT_THAT(refusal(solid_roof(), [](Template& templ) { templ.vertex_barycentric(2, 0) = -0.1; }),
              HasSubstr("vertex_barycentric at index 2 has the weight -0.1"));
  EXPECT_THAT(refusal(solid_roof(),
                      [](Template& templ) {
                        templ.vertex_barycentric(2, 1) = std::numeric_limits<double>::quiet_NaN();
                      }),
              HasSubstr("vertex_barycentric at index 2 has the weight"));
  EXPECT_THAT(refusal(solid_roof(),
                      [](Template& templ) {
                        templ.vertex_barycentric(2, 0) += 1e-4;
                        templ.vertex_barycentric(2, 1) -= 1e-4;
                      }),
              HasSubstr("vertex_barycentric at index 2 puts the vertex"));
}

TEST(TetrahedronVolume, IsThatOfTheCornerOfACube) {
  Points3 nodes_m(4, 3);
  nodes_m << 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0;
  Tetrahedra tetrahedra(2, 4);
  tetrahedra << 0, 1, 2, 3, 1, 0, 2, 3;
  EXPECT_NEAR(tetrahedron_volume(nodes_m, tetrahedra, 0), 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(tetrahedron_volume(nodes_m, tetrahedra, 1), -1.0 / 6.0, 1e-15);
}

}  // namespace
}  // namespace weft
