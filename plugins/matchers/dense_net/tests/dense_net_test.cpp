// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <weft/data/correspondences.hpp>
#include <weft/data/image.hpp>
#include <weft/data/matrix.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/inference/hash.hpp"
#include "common/inference/tests/test_network.hpp"

namespace weft::dense_net {
namespace {

using inference::testing::TestFolder;
using inference::testing::TestNetwork;
using ::testing::HasSubstr;
using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr double kErrorShare = 0.004;  // share of the width
constexpr testing::PoseSpec kPose{.distance_m = 0.6, .tilt_y_rad = 0.3};

/// A network that answers a bent surface, whatever the image shows.
struct DenseNet : ::testing::Test {
  TestFolder folder;
  Template templ = testing::make_template();
  Camera camera = testing::make_camera();
  DevelopableSheet sheet = testing::make_cylinder({}, 0.3, 0.3, kPose);
  TestNetwork network;

  DenseNet() {
    network.texture_hash = inference::texture_hash(templ.texture);
    inference::testing::show([&](double u, double v) { return sheet.at(x_m(u), y_m(v)); },
                             kErrorShare, network);
  }

  /// Position on the template of the shares of width and height; the edge is half a texel out.
  double x_m(double u) const { return 0.297 * u - 0.5 * templ.m_per_px(0); }
  double y_m(double v) const { return 0.178 * v - 0.5 * templ.m_per_px(1); }

  Image grey(std::uint8_t level = 90) const {
    Image image;
    image.pixels = Array<std::uint8_t>({camera.height_px, camera.width_px}, level);
    return image;
  }
  std::string params(const std::string& more = "") const {
    return "{network: " + network.write(folder) + more + "}";
  }
  PluginAnswer run(PluginUnderTest& plugin, const Image& image) const {
    return plugin.process(0, {testing::input("image", image), testing::input("template", templ),
                              testing::input("camera", camera)});
  }
  /// The number of seen cells that the network answers.
  int seen_count() const {
    int count = 0;
    for (int k = 0; k < network.cell_count(); ++k) count += network.cells[to_index(k)] > 0.0F;
    return count;
  }
  double off_px(const Correspondences& matches, std::int64_t i) const {
    const Eigen::Vector3d point =
        sheet.at(matches.template_xy_m(i, 0), matches.template_xy_m(i, 1));
    const Eigen::Vector2d seen = matches.image_px.matrix<2>().row(i);
    return (project(testing::pinhole(camera), point) - seen).norm();
  }
};

TEST_F(DenseNet, MatchesTheCentreOfEachCellToItsPointOfTheTemplate) {
  PluginUnderTest plugin("matchers/dense_net", params(", worst_share: 0"));
  const PluginAnswer out = run(plugin, grey());
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  const auto matches = *out.get<Correspondences>();
  EXPECT_EQ(matches.count(), seen_count());
  ASSERT_GT(matches.count(), 250);
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    EXPECT_LT(off_px(matches, i), 0.01) << i;
    EXPECT_NEAR(std::fmod(matches.image_px(i, 0), 16.0), 7.5, 1e-9);
    EXPECT_NEAR(matches.template_px(i, 0) * templ.m_per_px(0), matches.template_xy_m(i, 0), 1e-9);
    EXPECT_EQ(matches.face(i), -1);
    EXPECT_EQ(matches.kept(i), 1);
    EXPECT_NEAR(matches.score(i), 1.0 / (1.0 + std::exp(-6.0)), 1e-6);
  }
}

TEST_F(DenseNet, TrustsASetOfCellsLessTheLargerTheExpectedError) {
  double before = 1.0;
  for (const double share : {0.001, 0.003, 0.006, 0.02}) {
    network.uv_error_factor = share / kErrorShare;
    PluginUnderTest plugin("matchers/dense_net", params());
    const PluginAnswer out = run(plugin, grey());
    ASSERT_EQ(out.status, WEFT_OK) << out.message;
    const double now = out.get<Correspondences>()->confidence(0);
    EXPECT_LT(now, before) << share;
    EXPECT_EQ(now > 0.5, share < 0.004) << share;
    before = now;
  }
  EXPECT_LT(before, 1e-2);
}

TEST_F(DenseNet, StatesTheErrorInPixelsByTheLocalStretch) {
  network.uv_error_factor = 1.5;
  PluginUnderTest plugin("matchers/dense_net", params(", worst_share: 0"));
  const PluginAnswer out = run(plugin, grey());
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  const auto matches = *out.get<Correspondences>();
  const double error_m = 1.5 * kErrorShare * 0.297;
  EXPECT_NEAR(matches.diag.value("expected_error_mm", 0.0), 1e3 * error_m, 1e-3);
  double ratio = 0.0;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    const double* covariance = matches.covariance_px2.row(i);
    EXPECT_EQ(covariance[0], covariance[3]);
    EXPECT_EQ(covariance[1], 0.0);
    const double z_m = sheet.at(matches.template_xy_m(i, 0), matches.template_xy_m(i, 1)).z();
    // The surface is tilted, so that a pixel shows more of it than face on.
    const double frontal_px = error_m * camera.fx / z_m;
    EXPECT_LE(std::sqrt(covariance[0]), 1.01 * frontal_px) << i;
    ratio += std::sqrt(covariance[0]) / frontal_px / static_cast<double>(matches.count());
  }
  EXPECT_GT(ratio, 0.8);
  EXPECT_LT(ratio, 1.0);
}

TEST_F(DenseNet, NeverStatesLessThanTheLeastSigma) {
  PluginUnderTest plugin("matchers/dense_net", params(", sigma_px: 33"));
  const auto matches = *run(plugin, grey()).get<Correspondences>();
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    EXPECT_EQ(matches.covariance_px2.row(i)[0], 33.0 * 33.0);
  }
}

TEST_F(DenseNet, OmitsTheCellsThatAreLeastCertain) {
  // The larger the row the larger the error.
  for (int i = 0; i < network.rows(); ++i) {
    for (int j = 0; j < network.columns(); ++j) {
      network.cell(3, i, j) = -6.0F + 0.05F * static_cast<float>(i);
    }
  }
  PluginUnderTest all("matchers/dense_net", params(", worst_share: 0"));
  PluginUnderTest best("matchers/dense_net", params(", worst_share: 0.5"));
  const auto every = *run(all, grey()).get<Correspondences>();
  const auto half = *run(best, grey()).get<Correspondences>();
  ASSERT_EQ(half.count(), every.count() - every.count() / 2);
  for (std::int64_t i = 0; i < half.count(); ++i) {
    EXPECT_EQ(half.image_px(i, 0), every.image_px(i, 0));
    EXPECT_EQ(half.image_px(i, 1), every.image_px(i, 1));
  }
}

TEST_F(DenseNet, OmitsPointsBeyondTheTemplate) {
  network.cell(0, 0, 0) = network.cell(0, 0, 1) = 6.0F;
  network.cell(1, 0, 0) = 1.0F + 2.0F * static_cast<float>(kErrorShare);
  network.cell(1, 0, 1) = 1.0F + 0.5F * static_cast<float>(kErrorShare);
  PluginUnderTest plugin("matchers/dense_net", params(", worst_share: 0"));
  const auto matches = *run(plugin, grey()).get<Correspondences>();
  EXPECT_EQ(matches.diag.value("outside_cells", -1.0), 1.0);
  ASSERT_EQ(matches.count(), seen_count() - 1);
  EXPECT_EQ(matches.image_px(0, 0), 16.0 + 7.5);
  EXPECT_NEAR(matches.template_px(0, 0), 959.5, 1e-9) << "the right edge";
}

TEST_F(DenseNet, GivesNoMatchesOfFramesWithoutTheObject) {
  // The mask follows the brightness: its logit is 0.1 (grey level - 128) where the object is.
  network.from_rgb[0] = 0.1F;
  for (int k = 0; k < network.cell_count(); ++k) {
    network.cells[to_index(k)] = network.cells[to_index(k)] > 0.0F ? -12.8F : -40.0F;
  }
  PluginUnderTest plugin("matchers/dense_net", params());
  const PluginAnswer dark = run(plugin, grey(100));
  EXPECT_EQ(dark.status, WEFT_DEGENERATE);
  EXPECT_THAT(dark.message, HasSubstr("sees the object in 0 of 1200 cells, 20 are needed"));
  EXPECT_EQ(dark.get<Correspondences>()->count(), 0);
  EXPECT_EQ(dark.get<Correspondences>()->diag.value("visible_share", -1.0), 0.0);
  const PluginAnswer bright = run(plugin, grey(200));
  EXPECT_EQ(bright.status, WEFT_OK) << bright.message;
  EXPECT_GT(bright.get<Correspondences>()->count(), 200);
}

TEST_F(DenseNet, FollowsACameraOfAnotherSize) {
  camera = {700.0, 650.0, 322.0, 251.0, 640, 480};
  PluginUnderTest plugin("matchers/dense_net", params());
  const PluginAnswer out = run(plugin, grey());
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  const auto matches = *out.get<Correspondences>();
  ASSERT_GT(matches.count(), 200);
  for (std::int64_t i = 0; i < matches.count(); ++i) EXPECT_LT(off_px(matches, i), 0.01) << i;
}

TEST_F(DenseNet, RefusesAnotherTemplateAndANarrowLens) {
  PluginUnderTest plugin("matchers/dense_net", params());
  Template other = templ;
  other.texture = Array<std::uint8_t>({575, 960}, 17);
  const auto refused = plugin.prepare(other, camera);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("trained for another template"));
  camera.fx = camera.fy = 1500.0;
  const auto narrow = plugin.prepare(templ, camera);
  ASSERT_FALSE(narrow);
  EXPECT_THAT(narrow.error().message, HasSubstr("80 % are needed"));
}

TEST_F(DenseNet, NamesANetworkFileThatCannotBeUsed) {
  PluginUnderTest plugin("matchers/dense_net", params());
  inference::testing::write_file(folder.file("net.onnx"), "other");
  for (const bool is_frame : {false, true}) {
    const auto prepared = plugin.prepare(templ, camera);
    const std::string reason = is_frame ? run(plugin, grey()).message : prepared.error().message;
    EXPECT_THAT(reason, HasSubstr("net.onnx is not the file that"));
  }
}

TEST_F(DenseNet, GivesTheSameBytesFreshAndWarm) {
  network.from_rgb.fill(1e-5F);
  const std::string given = params();
  PluginUnderTest warm("matchers/dense_net", given), fresh("matchers/dense_net", given);
  run(warm, grey(30));
  const auto a = *run(warm, grey(200)).get<Correspondences>();
  const auto b = *run(fresh, grey(200)).get<Correspondences>();
  EXPECT_EQ(a.template_px.matrix<2>(), b.template_px.matrix<2>());
}

}  // namespace
}  // namespace weft::dense_net
