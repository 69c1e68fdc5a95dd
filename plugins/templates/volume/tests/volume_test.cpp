// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/solid/validation.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using weft::Template;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

std::string mesh_of(const std::string& name, const std::string& more = "") {
  const std::string data = WEFT_TEST_DATA;
  return "{use: templates/mesh, params: {mesh: '" + data + name + "', texture: '" + data +
         "sheet_texture.png', unit_m: 0.001" + more + "}}";
}

class VolumeTemplate : public ::testing::Test {
 protected:
  PluginAnswer build(const std::string& id, const std::string& params) {
    plugins_.push_back(std::make_unique<PluginUnderTest>(id, params));
    return plugins_.back()->process(0, {});
  }
  PluginAnswer filled(const std::string& surface, const std::string& more = "") {
    return build("templates/volume", "{surface: " + surface + more + "}");
  }
  Template built(const std::string& surface, const std::string& more = "") {
    const PluginAnswer outcome = filled(surface, more);
    EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
    auto templ = outcome.get<Template>();
    if (!templ) throw std::runtime_error("no template");
    return *std::move(templ);
  }

  std::vector<std::unique_ptr<PluginUnderTest>> plugins_;  // the templates live in them
};

TEST_F(VolumeTemplate, FillsEachOfTheObjects) {
  for (const char* name : {"block.obj", "can_2.obj", "can_6.obj", "cushion.obj", "box_24.obj"}) {
    SCOPED_TRACE(name);
    const Template templ = built(mesh_of(name));
    ASSERT_TRUE(templ.is_solid());
    ASSERT_TRUE(templ.welded_vertex.present());
    const auto valid = weft::validate_solid(templ);
    EXPECT_TRUE(valid) << valid.error().message;
    EXPECT_LT(templ.nodes_m.rows(), 2000);
  }
}

TEST_F(VolumeTemplate, FillsARemeshedSurfaceOfManyCharts) {
  for (const char* name : {"can_2.obj", "box_24.obj"}) {
    SCOPED_TRACE(name);
    const auto templ = filled(mesh_of(name, ", vertices: 250")).get<Template>();
    ASSERT_TRUE(templ);
    EXPECT_TRUE(weft::validate_solid(*templ));
    EXPECT_NEAR(static_cast<double>(templ->vertices_m.rows()), 250.0, 40.0);
  }
}

TEST_F(VolumeTemplate, KeepsTheSurfaceOfTheNestedTemplate) {
  const PluginAnswer nested =
      build("templates/mesh", "{mesh: '" WEFT_TEST_DATA "can_2.obj', texture: '" WEFT_TEST_DATA
                              "sheet_texture.png', unit_m: 0.001}");
  const auto surface = nested.get<Template>();
  ASSERT_TRUE(surface);
  const Template templ = built(mesh_of("can_2.obj"));
  EXPECT_EQ(templ.vertices_m.matrix<3>(), surface->vertices_m.matrix<3>());
  EXPECT_EQ(templ.flat_px.matrix<2>(), surface->flat_px.matrix<2>());
  EXPECT_EQ(templ.faces.matrix<3>(), surface->faces.matrix<3>());
  EXPECT_EQ(templ.welded_vertex.matrix<1>(), surface->welded_vertex.matrix<1>());
}

TEST_F(VolumeTemplate, PutsBothSidesOfASeamInOneTetrahedron) {
  const Template templ = built(mesh_of("can_2.obj"));
  for (std::int64_t v = 0; v < templ.vertices_m.rows(); ++v) {
    const std::int32_t twin = templ.welded_vertex(v);
    EXPECT_EQ(templ.vertex_tetrahedron(v), templ.vertex_tetrahedron(twin));
    for (int k = 0; k < 4; ++k) {
      EXPECT_EQ(templ.vertex_barycentric(v, k), templ.vertex_barycentric(twin, k));
    }
  }
}

TEST_F(VolumeTemplate, GivesTheFilledShareOfEachTetrahedron) {
  const Template templ = built(mesh_of("block.obj"));
  const auto* share = templ.others.find<double>("x.weft.filled_share");
  ASSERT_NE(share, nullptr);
  ASSERT_EQ(share->size(), templ.tetrahedra.rows());
  double volume_m3 = 0.0;
  for (std::int64_t e = 0; e < templ.tetrahedra.rows(); ++e) {
    volume_m3 += (*share)(e)*weft::tetrahedron_volume(templ.nodes_m.matrix<3>(),
                                                      templ.tetrahedra.matrix<4>(), e);
  }
  EXPECT_NEAR(volume_m3, 0.150 * 0.060 * 0.040, 0.05 * 0.150 * 0.060 * 0.040);
}

TEST_F(VolumeTemplate, UsesAFinerLatticeWhenAsked) {
  const Template coarse = built(mesh_of("block.obj"));
  const Template fine = built(mesh_of("block.obj"), ", pitch_m: 0.01");
  EXPECT_GT(fine.nodes_m.rows(), coarse.nodes_m.rows());
}

TEST_F(VolumeTemplate, RefusesAnOpenSurface) {
  const PluginAnswer outcome = filled(mesh_of("label.obj"));
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_THAT(outcome.message, AllOf(HasSubstr("is not closed"), HasSubstr("Close the holes")));
}

TEST_F(VolumeTemplate, RefusesASolidAsItsSurface) {
  const PluginAnswer outcome =
      filled("{use: templates/volume, params: {surface: " + mesh_of("block.obj") + "}}");
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_THAT(outcome.message, HasSubstr("is a solid already"));
}

TEST_F(VolumeTemplate, ReportsTheErrorOfItsSurface) {
  const PluginAnswer outcome = filled(mesh_of("block.obj", ", coordinates: flattened"));
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_THAT(outcome.message, HasSubstr("has texture coordinates"));
}

TEST_F(VolumeTemplate, RefusesAPitchThatDoesNotSuit) {
  for (const char* pitch : {"0.2", "0.0001", "1e-300"}) {
    const PluginAnswer outcome = filled(mesh_of("block.obj"), std::string(", pitch_m: ") + pitch);
    EXPECT_EQ(outcome.status, WEFT_ERROR) << pitch;
    EXPECT_THAT(outcome.message, HasSubstr("'pitch_m'"));
  }
  for (const char* pitch : {".nan", "-0.01", ".inf"}) {
    EXPECT_THROW(filled(mesh_of("block.obj"), std::string(", pitch_m: ") + pitch),
                 std::runtime_error)
        << pitch;
  }
}

}  // namespace
