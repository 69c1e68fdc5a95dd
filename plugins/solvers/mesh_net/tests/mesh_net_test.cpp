// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <iostream>
#include <string>
#include <weft/data/image.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/inference/hash.hpp"
#include "common/inference/tests/test_network.hpp"

namespace weft::mesh_net {
namespace {

using inference::testing::TestFolder;
using inference::testing::TestNetwork;
using ::testing::HasSubstr;
using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr std::uint64_t kMatchSeed = 21;
constexpr testing::PoseSpec kPose{.distance_m = 0.6, .tilt_y_rad = 0.3};

/// A network that answers a bent surface, whatever the image shows.
struct MeshNet : ::testing::Test {
  TestFolder folder;
  Template templ = testing::make_template({.columns = 25, .rows = 15});
  Camera camera = testing::make_camera();
  DevelopableSheet sheet = testing::make_cylinder({}, 0.3, 0.3, kPose);
  Points3 truth_m = testing::bent_vertices(templ, sheet);
  TestNetwork network;

  MeshNet() {
    network.texture_hash = inference::texture_hash(templ.texture);
    show(0.0008);
  }
  void show(double error_share) {
    inference::testing::show(
        [&](double u, double v) {
          return sheet.at(0.297 * u - 0.5 * templ.m_per_px(0), 0.178 * v - 0.5 * templ.m_per_px(1));
        },
        error_share, network);
  }
  /// Moves the vertex head, and leaves the cells as they are.
  void shift_nodes(float x_over_z) {
    for (int k = 0; k < network.node_count(); ++k) network.vertices[to_index(k)] += x_over_z;
  }

  std::string params() const { return "{network: " + network.write(folder) + "}"; }
  std::vector<testing::Input> inputs() const {
    Image image;
    image.pixels = Array<std::uint8_t>({camera.height_px, camera.width_px}, 90);
    return {testing::input("image", image), testing::input("template", templ),
            testing::input("camera", camera)};
  }
  double mean_error_m(const Shape& shape) const {
    return (Points3(shape.vertices_m.matrix<3>()) - truth_m).rowwise().norm().mean();
  }
};

TEST_F(MeshNet, GivesTheSurfaceOfItsNodesOnAFinerMesh) {
  PluginUnderTest plugin("solvers/mesh_net", params());
  const PluginAnswer out = plugin.process(0, inputs());
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  const auto shape = *out.get<Shape>();
  ASSERT_EQ(shape.vertices_m.rows(), 25 * 15);
  EXPECT_LT(mean_error_m(shape), 0.00005);
  EXPECT_EQ(shape.shape_state(), ShapeState::estimated);
  EXPECT_GT(shape.confidence, 0.98);
  EXPECT_LT(shape.diag.value("heads_distance_px", 99.0), 0.1);
}

TEST_F(MeshNet, MarksVerticesInSeenCellsAsMeasured) {
  for (int i = 0; i < network.rows(); ++i) {
    for (int j = 20; j < network.columns(); ++j) network.cell(0, i, j) = -6.0F;
  }
  PluginUnderTest plugin("solvers/mesh_net", params());
  const auto shape = *plugin.process(0, inputs()).get<Shape>();
  int measured = 0;
  for (std::int64_t v = 0; v < shape.vertices_m.rows(); ++v) {
    const double x_px = camera.fx * truth_m(v, 0) / truth_m(v, 2) + camera.cx;
    if (x_px > 321.0) {
      EXPECT_EQ(shape.source(v), 0) << v;
    }
    measured += shape.source(v);
  }
  EXPECT_GT(measured, 100);
}

/// A cell has 16 px of the frame; sigma is 0.004 x 297 mm, at 0.6 m 1.6 px.
TEST_F(MeshNet, IsWeakWhereItsHeadsDisagree) {
  shift_nodes(10.0F / 820.0F);
  PluginUnderTest near("solvers/mesh_net", params());
  EXPECT_EQ(near.process(0, inputs()).get<Shape>()->shape_state(), ShapeState::estimated);
  shift_nodes(20.0F / 820.0F);
  PluginUnderTest far("solvers/mesh_net", params());
  const auto shape = *far.process(0, inputs()).get<Shape>();
  EXPECT_EQ(shape.shape_state(), ShapeState::weak);
  EXPECT_LT(shape.confidence, 0.1);
  EXPECT_NEAR(shape.diag.value("heads_distance_px", 0.0), 30.0, 0.5);
}

TEST_F(MeshNet, IsWeakHoweverUncertainItsCellsAre) {
  show(0.5);
  shift_nodes(60.0F / 820.0F);
  PluginUnderTest plugin("solvers/mesh_net", params());
  EXPECT_EQ(plugin.process(0, inputs()).get<Shape>()->shape_state(), ShapeState::weak);
}

TEST_F(MeshNet, HasNoResultWithoutTheObject) {
  for (int k = 0; k < network.cell_count(); ++k) network.cells[to_index(k)] = k < 11 ? 6.0F : -6.0F;
  PluginUnderTest plugin("solvers/mesh_net", params());
  const PluginAnswer out = plugin.process(0, inputs());
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  EXPECT_THAT(out.message, HasSubstr("sees the object in 0.9 % of the image, 1.0 % are needed"));
  network.cells[11] = 6.0F;
  PluginUnderTest enough("solvers/mesh_net", params());
  EXPECT_EQ(enough.process(0, inputs()).status, WEFT_OK);
}

TEST_F(MeshNet, HasNoResultWithoutADepth) {
  network.node(2, 3, 4) = 80.0F;
  PluginUnderTest plugin("solvers/mesh_net", params());
  const PluginAnswer out = plugin.process(0, inputs());
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  EXPECT_THAT(out.message, HasSubstr("not in front of the camera"));
}

TEST_F(MeshNet, NeedsAFlatTemplateOfItsTraining) {
  PluginUnderTest plugin("solvers/mesh_net", params());
  Template bent = templ;
  bent.vertices_m = make_array<double>(truth_m);
  const auto refused = plugin.prepare(bent, camera);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("needs a flat rectangular template"));
  templ.texture = Array<std::uint8_t>({575, 960}, 3);
  EXPECT_THAT(plugin.process(0, inputs()).message, HasSubstr("trained for another template"));
}

TEST_F(MeshNet, RefusesANetworkForAnyTexture) {
  network.texture_px = 120;
  PluginUnderTest plugin("solvers/mesh_net", params());
  const auto refused = plugin.prepare(templ, camera);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("has no vertices: use matchers/dense_net"));
}

TEST_F(MeshNet, IsAnInitialGuessOfGaussNewton) {
  std::cout << "seed " << kMatchSeed << "\n";
  Rng rng(kMatchSeed);
  auto all = inputs();
  all.push_back(
      testing::input("correspondences",
                     testing::draw_matches(templ, camera, sheet, {.noise_px = 0.5}, rng).matches));
  const auto solved = [&](const std::string& guess) {
    PluginUnderTest plugin("solvers/gauss_newton",
                           "{initial_guess: {use: solvers/mesh_net, params: " + guess + "}}");
    return plugin.process(0, all);
  };
  PluginUnderTest plugin("solvers/gauss_newton",
                         "{initial_guess: {use: solvers/mesh_net, params: " + params() + "}}");
  const PluginAnswer out = plugin.process(0, all);
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  EXPECT_LT(mean_error_m(*out.get<Shape>()), 0.002);
  network.texture_hash = "0000000000000000";
  EXPECT_THAT(solved(params()).message, HasSubstr("trained for another template"));
}

}  // namespace
}  // namespace weft::mesh_net
