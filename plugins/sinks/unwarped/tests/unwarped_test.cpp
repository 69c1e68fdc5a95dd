// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <weft/core/rng.hpp>
#include <weft/data/image.hpp>
#include <weft/data/shape.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/cameras/tests/frame_folder.hpp"

namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using weft::Camera;
using weft::Image;
using weft::Shape;
using weft::ShapeState;
using weft::Template;
using weft::testing::input;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr int kOpen = 0, kWrite = 1, kFinish = 2;
constexpr int kWidthPx = 60, kHeightPx = 40, kBorderPx = 10;
constexpr double kM_per_px = 5e-4;
constexpr std::uint64_t kSeed = 20261129;

/// A texture that faces the camera at a distance where a texel is as large as a pixel: the image is
/// the texture with a border of white.
class Unwarped : public ::testing::Test {
 protected:
  Unwarped()
      : templ_(weft::testing::make_template({.columns = 7,
                                             .rows = 5,
                                             .width_m = kM_per_px * kWidthPx,
                                             .height_m = kM_per_px * kHeightPx,
                                             .width_px = kWidthPx,
                                             .height_px = kHeightPx})),
        camera_{120.0,
                120.0,
                kBorderPx,
                kBorderPx,
                kWidthPx + 2 * kBorderPx,
                kHeightPx + 2 * kBorderPx} {
    RecordProperty("seed", std::to_string(kSeed));
    weft::Rng rng(kSeed);
    templ_.texture = weft::Array<std::uint8_t>({kHeightPx, kWidthPx, 3});
    for (std::int64_t i = 0; i < templ_.texture.size(); ++i) {
      templ_.texture.data()[i] = static_cast<std::uint8_t>(rng.uniform(0.0, 255.0));
    }
    image_.pixels = weft::Array<std::uint8_t>(
        {kHeightPx + 2 * kBorderPx, kWidthPx + 2 * kBorderPx, 3}, std::uint8_t{255});
    for (int y = 0; y < kHeightPx; ++y) {
      for (int x = 0; x < kWidthPx; ++x) {
        for (int c = 0; c < 3; ++c) {
          image_.pixels.row(y + kBorderPx)[3 * (x + kBorderPx) + c] =
              static_cast<std::uint8_t>(texel(x, y, c));
        }
      }
    }
    shape_.vertices_m = weft::Array<double>({templ_.vertices_m.rows(), 3});
    // Texel (u,v) is seen at pixel (u + border, v + border): fx X / Z = u with Z = fx * pitch.
    for (std::int64_t v = 0; v < templ_.vertices_m.rows(); ++v) {
      shape_.vertices_m(v, 0) = kM_per_px * templ_.flat_px(v, 0);
      shape_.vertices_m(v, 1) = kM_per_px * templ_.flat_px(v, 1);
      shape_.vertices_m(v, 2) = 120.0 * kM_per_px;
    }
    shape_.source = weft::Array<std::uint8_t>({templ_.vertices_m.rows()}, std::uint8_t{1});
    shape_.state = static_cast<std::int32_t>(ShapeState::estimated);
  }
  int texel(int x, int y, int channel) const { return templ_.texture.row(y)[3 * x + channel]; }

  std::string folder() const { return folder_.path("unwarped"); }

  PluginUnderTest sink(const std::string& more = "") const {
    return PluginUnderTest("sinks/unwarped", "{path: " + folder() + more + "}");
  }

  PluginAnswer write(PluginUnderTest& sink) {
    return sink.process(kWrite, {input("image", image_), input("camera", camera_),
                                 input("template", templ_), input("shape", shape_)});
  }

  Template templ_;
  Camera camera_;
  Image image_;
  Shape shape_;

 private:
  weft::testing::FrameFolder folder_;
};

TEST_F(Unwarped, IsThePrintWhereTheShapeIsRight) {
  auto plugin = sink();
  ASSERT_EQ(plugin.process(kOpen, {}).status, WEFT_OK);
  ASSERT_EQ(write(plugin).status, WEFT_OK);
  ASSERT_EQ(plugin.process(kFinish, {}).status, WEFT_OK);
  const cv::Mat texels = cv::imread(folder() + "/000000.png", cv::IMREAD_UNCHANGED);
  ASSERT_EQ(texels.size(), cv::Size(kWidthPx, kHeightPx));
  ASSERT_EQ(texels.type(), CV_8UC3);
  int off = 0;
  for (int y = 0; y < kHeightPx; ++y) {
    for (int x = 0; x < kWidthPx; ++x) {
      for (int c = 0; c < 3; ++c) {
        if (std::abs(texels.at<cv::Vec3b>(y, x)[c] - texel(x, y, c)) > 1) ++off;
      }
    }
  }
  EXPECT_EQ(off, 0);
}

TEST_F(Unwarped, IsMovedByATexelWhereTheShapeIs) {
  for (std::int64_t v = 0; v < shape_.vertices_m.rows(); ++v) shape_.vertices_m(v, 0) += kM_per_px;
  auto plugin = sink();
  ASSERT_EQ(plugin.process(kOpen, {}).status, WEFT_OK);
  ASSERT_EQ(write(plugin).status, WEFT_OK);
  const cv::Mat texels = cv::imread(folder() + "/000000.png", cv::IMREAD_UNCHANGED);
  ASSERT_EQ(texels.size(), cv::Size(kWidthPx, kHeightPx));
  EXPECT_NEAR(texels.at<cv::Vec3b>(20, 30)[1], texel(31, 20, 1), 1);
  EXPECT_EQ(texels.at<cv::Vec3b>(20, kWidthPx - 1)[1], 255) << "the border of the image";
}

TEST_F(Unwarped, IsNotWrittenForAShapeThatTheFrameDidNotShow) {
  auto plugin = sink(", format: jpg");
  ASSERT_EQ(plugin.process(kOpen, {}).status, WEFT_OK);
  shape_.state = static_cast<std::int32_t>(ShapeState::predicted);
  EXPECT_EQ(write(plugin).status, WEFT_OK);
  EXPECT_FALSE(fs::exists(folder() + "/000000.jpg"));
  shape_.state = static_cast<std::int32_t>(ShapeState::weak);
  EXPECT_EQ(write(plugin).status, WEFT_OK);
  EXPECT_TRUE(fs::exists(folder() + "/000000.jpg"));
}

TEST_F(Unwarped, RefusesAShapeOfAnotherTemplate) {
  auto plugin = sink();
  ASSERT_EQ(plugin.process(kOpen, {}).status, WEFT_OK);
  shape_.vertices_m = weft::Array<double>({3, 3}, 1.0);
  shape_.source = weft::Array<std::uint8_t>({3}, std::uint8_t{1});
  const PluginAnswer answer = write(plugin);
  EXPECT_NE(answer.status, WEFT_OK);
  EXPECT_THAT(answer.message, HasSubstr("use one template throughout"));
}

}  // namespace
