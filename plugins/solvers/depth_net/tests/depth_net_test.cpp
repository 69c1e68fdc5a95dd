// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/data/image.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/inference/hash.hpp"
#include "common/inference/tests/test_network.hpp"

namespace weft::depth_net {
namespace {

using inference::testing::TestFolder;
using inference::testing::TestNetwork;
using ::testing::HasSubstr;
using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr std::uint64_t kNoiseSeed = 5;
constexpr testing::PoseSpec kPose{.distance_m = 0.6, .tilt_y_rad = 0.3};
constexpr int kMask = 0, kDepth = 4;

/// A network whose cells answer a bent surface, whatever the image shows, and whose vertex head
/// answers nonsense.
struct DepthNet : ::testing::Test {
  TestFolder folder;
  Template templ = testing::make_template({.columns = 25, .rows = 15});
  Camera camera = testing::make_camera();
  Points3 truth_m;
  TestNetwork network;
  std::vector<std::unique_ptr<PluginUnderTest>> plugins;

  DepthNet() {
    network.texture_hash = inference::texture_hash(templ.texture);
    show(testing::make_cylinder({}, 0.3, 0.3, kPose));
  }
  void show(const DevelopableSheet& sheet) {
    truth_m = testing::bent_vertices(templ, sheet);
    inference::testing::show(
        [&](double u, double v) {
          return sheet.at(0.297 * u - 0.5 * templ.m_per_px(0), 0.178 * v - 0.5 * templ.m_per_px(1));
        },
        0.0008, network);
    network.vertices.assign(to_index(3 * network.node_count()), 5.0F);
  }
  void show_plane() { show(testing::make_bent_sheet({}, {}, kPose)); }

  /// Hides the cells for which `is_hidden(row, column)`.
  void hide(const std::function<bool(int, int)>& is_hidden) {
    for (int i = 0; i < network.rows(); ++i) {
      for (int j = 0; j < network.columns(); ++j) {
        if (is_hidden(i, j)) network.cell(kMask, i, j) = -6.0F;
      }
    }
  }

  std::vector<testing::Input> inputs() const {
    Image image;
    image.pixels = Array<std::uint8_t>({camera.height_px, camera.width_px}, 90);
    return {testing::input("image", image), testing::input("template", templ),
            testing::input("camera", camera)};
  }
  /// The arrays of an answer belong to its plugin, which lives as long as the test case.
  PluginAnswer solve(const std::string& more = "") {
    plugins.push_back(std::make_unique<PluginUnderTest>(
        "solvers/depth_net", "{network: " + network.write(folder) + more + "}"));
    return plugins.back()->process(0, inputs());
  }
  Eigen::VectorXd errors_m(const Shape& shape) const {
    return (Points3(shape.vertices_m.matrix<3>()) - truth_m).rowwise().norm();
  }
};

TEST_F(DepthNet, GivesAPlaneExactly) {
  show_plane();
  const PluginAnswer out = solve();
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  const auto shape = *out.get<Shape>();
  EXPECT_LT(errors_m(shape).maxCoeff(), 1e-6);
  EXPECT_EQ(shape.shape_state(), ShapeState::estimated);
  EXPECT_GT(shape.confidence, 0.98);
  EXPECT_LT(shape.diag.value("mean_strain", 1.0), 1e-5);
  EXPECT_GT(shape.diag.value("measured_share", 0.0), 0.95);
}

TEST_F(DepthNet, ContinuesAPlaneRigidlyWhereItIsHidden) {
  show_plane();
  hide([](int, int column) { return column >= 20; });
  const PluginAnswer out = solve();
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  const auto shape = *out.get<Shape>();
  EXPECT_LT(errors_m(shape).maxCoeff(), 1e-6);
  EXPECT_EQ(shape.shape_state(), ShapeState::estimated);
  // Cells have 16 px; one is at most one cell from the last that is seen.
  int measured = 0;
  for (std::int64_t v = 0; v < shape.vertices_m.rows(); ++v) {
    const double x_px = camera.fx * truth_m(v, 0) / truth_m(v, 2) + camera.cx;
    EXPECT_TRUE(shape.source(v) == 0 || x_px < 19.0 * 16.0 + 7.5 + 20.0) << v;
    measured += shape.source(v);
  }
  EXPECT_GT(measured, 150);
}

TEST_F(DepthNet, FollowsABentSheet) {
  const auto shape = *solve().get<Shape>();
  std::cout << "mean " << 1e3 * errors_m(shape).mean() << " mm, largest "
            << 1e3 * errors_m(shape).maxCoeff() << " mm\n";
  EXPECT_LT(errors_m(shape).mean(), 0.001);
  EXPECT_LT(errors_m(shape).maxCoeff(), 0.005);
  EXPECT_EQ(shape.shape_state(), ShapeState::estimated);
  EXPECT_LT(shape.diag.value("mean_strain", 1.0), 0.005);
}

TEST_F(DepthNet, KeepsTheLengthsOfAHiddenBentPart) {
  hide([](int, int column) { return column >= 20; });
  const auto shape = *solve().get<Shape>();
  const Eigen::VectorXd off_m = errors_m(shape);
  for (Eigen::Index v = 0; v < off_m.size(); ++v) {
    // A surface of this radius leaves its tangent by up to 37 mm over the hidden 15 cm.
    EXPECT_LT(off_m(v), shape.source(v) == 1 ? 0.008 : 0.06) << v;
  }
  EXPECT_LT(shape.diag.value("mean_strain", 1.0), 0.005);
}

/// The depths of cells are wrong independently by 1 %, 6 mm.
TEST_F(DepthNet, AveragesTheNoiseOfItsCells) {
  std::cout << "seed " << kNoiseSeed << "\n";
  Rng rng(kNoiseSeed);
  for (int i = 0; i < network.rows(); ++i) {
    for (int j = 0; j < network.columns(); ++j) {
      network.cell(kDepth, i, j) += static_cast<float>(0.01 * rng.normal());
    }
  }
  const auto shape = *solve().get<Shape>();
  std::cout << "mean " << 1e3 * errors_m(shape).mean() << " mm, strain "
            << shape.diag.value("mean_strain", 1.0) << "\n";
  EXPECT_LT(errors_m(shape).mean(), 0.002);
  EXPECT_EQ(shape.shape_state(), ShapeState::estimated);
  EXPECT_LT(shape.diag.value("mean_strain", 1.0), 0.01);
}

TEST_F(DepthNet, IgnoresCellsThatAreFarOff) {
  show_plane();
  for (int j = 12; j < 28; j += 5) network.cell(kDepth, 13, j) += 0.5F;
  const auto shape = *solve().get<Shape>();
  EXPECT_LT(errors_m(shape).maxCoeff(), 0.0005);
  EXPECT_GT(shape.confidence, 0.93);
  EXPECT_LT(shape.confidence, 1.0);
}

TEST_F(DepthNet, IsWeakWhereNoRigidSurfaceFitsItsCells) {
  for (int i = 0; i < network.rows(); ++i) {
    for (int j = 0; j < network.columns(); ++j) {
      network.cell(kDepth, i, j) += (i + j) % 2 == 0 ? 0.15F : -0.15F;
    }
  }
  const auto shape = *solve().get<Shape>();
  EXPECT_EQ(shape.shape_state(), ShapeState::weak);
  EXPECT_LT(shape.confidence, 0.5);
}

TEST_F(DepthNet, IsWeakWhereTheSurfaceStretches) {
  for (int k = 0; k < network.cell_count(); ++k) {
    network.cells[to_index(kDepth * network.cell_count() + k)] += 0.2F;
  }
  const auto shape = *solve(", rigidity_m: 0.1").get<Shape>();
  EXPECT_GT(shape.diag.value("cells_agree", 0.0), 0.99);
  EXPECT_NEAR(shape.diag.value("mean_strain", 0.0), std::exp(0.2) - 1.0, 0.02);
  EXPECT_EQ(shape.shape_state(), ShapeState::weak);
  const auto rigid = *solve(", rigidity_m: 0.00001").get<Shape>();
  EXPECT_LT(rigid.diag.value("mean_strain", 1.0), 0.02);
}

TEST_F(DepthNet, HasNoResultWithoutTheObject) {
  const auto seen_before = network.cells;
  hide([](int, int) { return true; });
  for (int k = 0; k < 11; ++k) network.cell(kMask, 14 + k / 4, 18 + k % 4) = 6.0F;
  const PluginAnswer out = solve();
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  EXPECT_THAT(out.message, HasSubstr("sees the object in 0.9 % of the image, 1.0 % are needed"));
  network.cell(kMask, 16, 21) = 6.0F;
  const PluginAnswer enough = solve();
  EXPECT_EQ(enough.status, WEFT_OK) << enough.message;
  EXPECT_LT(errors_m(*enough.get<Shape>()).mean(), 0.1);
}

TEST_F(DepthNet, HasNoResultFromALineOfTheTemplate) {
  show_plane();
  for (int k = 0; k < network.cell_count(); ++k) {
    const float u = network.cells[to_index(network.cell_count() + k)];
    network.cells[to_index(2 * network.cell_count() + k)] = 0.2F + 0.5F * u;
  }
  const PluginAnswer out = solve();
  EXPECT_EQ(out.status, WEFT_NO_RESULT);
  EXPECT_THAT(out.message, HasSubstr("lie on a line of the template"));
}

TEST_F(DepthNet, HasNoResultWithoutDepths) {
  for (const float log_depth : {-40.0F, 40.0F}) {
    for (int k = 0; k < network.cell_count(); ++k) {
      network.cells[to_index(kDepth * network.cell_count() + k)] = log_depth;
    }
    const PluginAnswer out = solve();
    EXPECT_EQ(out.status, WEFT_NO_RESULT);
    EXPECT_THAT(out.message, HasSubstr("only 0 cells show a point of the template"));
  }
}

TEST_F(DepthNet, NeedsAFlatTemplateOfItsTraining) {
  PluginUnderTest plugin("solvers/depth_net", "{network: " + network.write(folder) + "}");
  Template bent = templ;
  bent.vertices_m = make_array<double>(truth_m);
  const auto refused = plugin.prepare(bent, camera);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("needs a flat rectangular template"));
  templ.texture = Array<std::uint8_t>({575, 960}, 3);
  EXPECT_THAT(plugin.process(0, inputs()).message, HasSubstr("trained for another template"));
}

TEST_F(DepthNet, FollowsAFinerMeshOfTheSameTemplate) {
  PluginUnderTest plugin("solvers/depth_net", "{network: " + network.write(folder) + "}");
  templ.revision = 1;
  const auto coarse = *plugin.process(0, inputs()).get<Shape>();
  EXPECT_EQ(coarse.vertices_m.rows(), 25 * 15);
  templ = testing::make_template({.columns = 33, .rows = 20});
  templ.revision = 2;
  truth_m = testing::bent_vertices(templ, testing::make_cylinder({}, 0.3, 0.3, kPose));
  const PluginAnswer out = plugin.process(0, inputs());
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  const auto fine = *out.get<Shape>();
  ASSERT_EQ(fine.vertices_m.rows(), 33 * 20);
  EXPECT_LT(errors_m(fine).mean(), 0.001);
}

}  // namespace
}  // namespace weft::depth_net
