// SPDX-License-Identifier: Apache-2.0
#include "common/inference/registration.hpp"

#include <gmock/gmock.h>

#include <weft/testing/synthetic.hpp>

#include "common/inference/hash.hpp"
#include "common/inference/tests/test_network.hpp"

namespace weft::inference {
namespace {

using ::testing::HasSubstr;
using testing::TestFolder;
using testing::TestNetwork;

struct RegistrationTest : ::testing::Test {
  TestFolder folder;
  Template templ = weft::testing::make_template();
  Camera camera = weft::testing::make_camera();
  TestNetwork network;
  Registration registration;

  RegistrationTest() { network.texture_hash = texture_hash(templ.texture); }

  Image grey() const {
    Image image;
    image.pixels = Array<std::uint8_t>({camera.height_px, camera.width_px}, 90);
    return image;
  }
  std::vector<SeenCell> seen() {
    const auto ready = registration.prepare({network.write(folder)}, templ, camera);
    EXPECT_TRUE(ready) << ready.error().message;
    const auto maps = registration.run(grey(), 1);
    EXPECT_TRUE(maps) << maps.error().message;
    return registration.seen_cells(*maps, 0.6);
  }
};

/// A plane face on at 0.6 m: 1 px of the frame is 0.6 / 820 m of the template.
TEST_F(RegistrationTest, KnowsPlaceErrorAndStretchOfEachCell) {
  testing::show(
      [&](double u, double v) {
        return Eigen::Vector3d(0.297 * (u - 0.5), 0.178 * (v - 0.5), 0.6);
      },
      0.01, network);
  network.uv_error_factor = 2.0;
  const std::vector<SeenCell> cells = seen();
  ASSERT_GT(cells.size(), 300U);
  for (const SeenCell& cell : cells) {
    EXPECT_NEAR(cell.image_px.x(), 16.0 * cell.column + 7.5, 1e-9);
    EXPECT_NEAR(cell.image_px.y(), 16.0 * cell.row + 7.5, 1e-9);
    const double x_m = (cell.image_px.x() - camera.cx) * 0.6 / camera.fx;
    EXPECT_NEAR(cell.uv.x(), 0.5 + x_m / 0.297, 1e-6);
    EXPECT_NEAR(cell.error_m, 2.0 * 0.01 * 0.297, 1e-6);
    EXPECT_NEAR(cell.depth_m, 0.6, 1e-6);
    EXPECT_NEAR(cell.stretch_m_per_px, 0.6 / 820.0, 1e-6);
    EXPECT_NEAR(sigma_px(cell, 1.5, 100.0), 0.00594 * 820.0 / 0.6, 0.05);
  }
  EXPECT_EQ(sigma_px(cells.front(), 30.0, 100.0), 30.0);
  EXPECT_EQ(sigma_px(cells.front(), 1.0, 4.0), 4.0);
}

TEST_F(RegistrationTest, GivesALoneCellTheMedianStretch) {
  for (int i = 0; i < 30; ++i) {
    for (int j = 0; j < 40; ++j) {
      const bool seen = (i < 4 && j < 4) || (i == 20 && j == 20);
      network.cell(0, i, j) = seen ? 9.0F : -9.0F;
      network.cell(1, i, j) = 0.01F * static_cast<float>(j);
      network.cell(2, i, j) = 0.01F * static_cast<float>(i) * 0.297F / 0.178F;
      network.cell(4, i, j) = -20.0F;  // so near that the frontal bound does not count
    }
  }
  const std::vector<SeenCell> cells = seen();
  ASSERT_EQ(cells.size(), 17U);
  EXPECT_NEAR(cells.back().stretch_m_per_px, 0.00297 / 16.0, 1e-8);
  EXPECT_NEAR(cells.front().stretch_m_per_px, 0.00297 / 16.0, 1e-8);
}

TEST_F(RegistrationTest, HasFiniteErrorsAndDepthsForAnyLogarithms) {
  for (int c : {3, 4}) network.cell(c, 0, 0) = 1e30F;
  for (int c : {3, 4}) network.cell(c, 0, 1) = -1e30F;
  for (int j : {0, 1}) network.cell(0, 0, j) = 9.0F;
  const std::vector<SeenCell> cells = seen();
  ASSERT_EQ(cells.size(), 2U);
  for (const SeenCell& cell : cells) {
    EXPECT_TRUE(std::isfinite(cell.error_m) && cell.error_m > 0.0);
    EXPECT_TRUE(std::isfinite(cell.depth_m) && cell.depth_m > 0.0);
    EXPECT_TRUE(std::isfinite(cell.stretch_m_per_px) && cell.stretch_m_per_px > 0.0);
  }
}

TEST_F(RegistrationTest, NeedsTheTemplateAndTheCameraOfItsTraining) {
  const std::string path = network.write(folder);
  ASSERT_TRUE(registration.prepare({path}, templ, camera));
  Template other = weft::testing::make_template({.width_m = 0.3});
  const auto refused = registration.prepare({path}, other, camera);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("trained for another template"));
  camera.fx = camera.fy = 2000.0;
  const auto narrow = registration.prepare({path}, templ, camera);
  ASSERT_FALSE(narrow);
  EXPECT_THAT(narrow.error().message, HasSubstr("of the field that the network"));
}

TEST_F(RegistrationTest, RefusesAnImageOfAnotherSize) {
  ASSERT_TRUE(registration.prepare({network.write(folder)}, templ, camera));
  Image image = grey();
  image.pixels = Array<std::uint8_t>({480, 641}, 0);
  const auto refused = registration.run(image, 1);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("640 x 480 px"));
}

/// A network that sees the object where the texture is red, and everywhere the same place of it.
struct AnyTextureTest : RegistrationTest {
  AnyTextureTest() {
    network.texture_px = 120;
    network.from_rgb[0] = 0.1F;
    for (int k = 0; k < network.cell_count(); ++k) {
      const float values[] = {-12.8F, 0.5F, 0.25F, std::log(0.01F), std::log(2.0F), -3.0F};
      for (int c = 0; c < 6; ++c) network.cell(c, k / 40, k % 40) = values[c];
    }
    templ.texture = Array<std::uint8_t>({575, 960, 3}, 0);
    for (int v = 0; v < 575; ++v) {
      for (int u = 0; u < 480; ++u) templ.texture.row(v)[3 * u + 2] = 255;
    }
  }
  std::string refusal() {
    const auto prepared = registration.prepare({network.write(folder)}, templ, camera);
    return prepared ? "" : prepared.error().message;
  }
};

TEST_F(AnyTextureTest, TakesTheTextureOfTheTemplateBelowTheImage) {
  network.uv_error_factor = 2.0;
  const std::vector<SeenCell> cells = seen();
  // 960 texels are 120 px, so that the left half of the texture is the cells of 60 px.
  ASSERT_EQ(cells.size(), 15U * 30U);
  for (const SeenCell& cell : cells) {
    EXPECT_LT(cell.column, 15);
    EXPECT_NEAR(cell.uv.x(), 480.0 / 960.0, 1e-6);
    EXPECT_NEAR(cell.uv.y(), 240.0 / 575.0, 1e-6) << "a quarter of the square is 240 texels";
    EXPECT_NEAR(cell.error_m, 2.0 * 0.01 * 0.297, 1e-6);
    EXPECT_NEAR(cell.depth_m, 2.0 * 0.297, 1e-5) << "twice the longer side";
  }
}

TEST_F(AnyTextureTest, TakesEveryCameraAndScalesTheDepthByItsFocalLength) {
  camera = {1000.0, 1000.0, 239.5, 319.5, 480, 640};
  const std::vector<SeenCell> cells = seen();
  // The frame is 90 px wide in the image of the network: only its cells count.
  ASSERT_EQ(cells.size(), 15U * 30U);
  EXPECT_NEAR(cells[0].depth_m, 2.0 * 0.297 * (1000.0 * 120.0 / 640.0) / 205.0, 1e-5);
  EXPECT_NEAR(cells[0].image_px.x(), 2.0 * 640.0 / 120.0 - 0.5, 1e-9);
}

TEST_F(AnyTextureTest, RefusesTexturesThatItCannotShow) {
  templ.texture = Array<std::uint8_t>({575, 960, 2}, 0);
  EXPECT_THAT(refusal(), HasSubstr("the texture must have one or three channels"));
  templ.texture = {};
  EXPECT_THAT(refusal(), HasSubstr("has no mesh or no texture"));
}

TEST_F(AnyTextureTest, RefusesAnotherSideThanThatOfTheOnnxFile) {
  const std::string onnx = network.model().bytes();
  network.texture_px = 96;
  const auto refused = registration.prepare({network.write(folder, onnx)}, templ, camera);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("net.onnx"));
}

}  // namespace
}  // namespace weft::inference
