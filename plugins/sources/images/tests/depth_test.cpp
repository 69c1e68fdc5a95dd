// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>
#include <weft/data/ground_truth.hpp>

#include "images_source.hpp"

namespace weft::testing {
namespace {

using ::testing::HasSubstr;

/// Depth in which each pixel differs from its neighbours; 0 in the left column.
cv::Mat depth_of(const cv::Size& size) {
  cv::Mat depth(size, CV_16UC1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      depth.at<std::uint16_t>(y, x) = x == 0 ? 0 : static_cast<std::uint16_t>(500 + 7 * x + y);
    }
  }
  return depth;
}

/// Two frames; the second has a depth image.
void fill(const FrameFolder& folder, const cv::Size& size = {8, 6}) {
  folder.write("camera.yaml",
               "{fx: 900, fy: 900, cx: 4, cy: 3, width: " + std::to_string(size.width) +
                   ", height: " + std::to_string(size.height) + "}");
  for (const char* name : {"frames/a.png", "frames/b.png"}) {
    folder.write_image(name, cv::Mat(size, CV_8UC1, cv::Scalar(90)));
  }
  folder.write_image("depth/b.png", depth_of(size));
}

PluginUnderTest with_depth(const FrameFolder& folder, const std::string& more = "") {
  return images_source(folder, "frames/*.png",
                       "depth: '" + folder.path("depth/*.png") + "'" + more);
}

class DepthOfSize : public ::testing::TestWithParam<cv::Size> {};

TEST_P(DepthOfSize, IsThatOfTheFileInMetres) {
  const cv::Size size = GetParam();
  const FrameFolder folder;
  fill(folder, size);
  auto source = with_depth(folder);
  const PluginAnswer opened = source.process(kOpen, {});
  ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
  EXPECT_FALSE(source.process(kRead, {}, 0).get<GroundTruth>().has_value());
  const PluginAnswer read = source.process(kRead, {}, 1);
  const auto truth = read.get<GroundTruth>();
  ASSERT_TRUE(truth.has_value()) << read.message;
  EXPECT_EQ(truth->kind, "depth");
  EXPECT_EQ(truth->count(), 0);
  ASSERT_EQ(truth->depth_m.dim(0), size.height);
  ASSERT_EQ(truth->depth_m.dim(1), size.width);
  int wrong = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const float expected = x == 0 ? 0.0F : static_cast<float>(0.001 * (500 + 7 * x + y));
      wrong += truth->depth_m(y, x) != expected;
    }
  }
  EXPECT_EQ(wrong, 0);
}

INSTANTIATE_TEST_SUITE_P(Cameras, DepthOfSize,
                         ::testing::Values(cv::Size(640, 480), cv::Size(1280, 720)));

TEST(Depth, HasTheUnitThatIsGiven) {
  const FrameFolder folder;
  fill(folder);
  auto source = with_depth(folder, ", depth_unit_m: 0.0002");
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  EXPECT_FLOAT_EQ(source.process(kRead, {}, 1).get<GroundTruth>()->depth_m(2, 3), 0.1046F);
}

TEST(Depth, JoinsTheTruePointsOfItsFrame) {
  const FrameFolder folder;
  fill(folder);
  folder.write(
      "gt/b_mdh.csv",
      "point_id,template_x_mm,template_y_mm,u_px,v_px,X_mm,Y_mm,Z_mm\n1,0,0,1,2,3,4,500\n");
  auto source = with_depth(folder, ", truth: '" + folder.path("gt/*.csv") + "'");
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  const auto truth = source.process(kRead, {}, 1).get<GroundTruth>();
  EXPECT_EQ(truth->kind, "mdh");
  EXPECT_EQ(truth->count(), 1);
  EXPECT_TRUE(truth->depth_m.present());
}

TEST(Depth, WithoutAFrameIsRefused) {
  const FrameFolder folder;
  fill(folder);
  folder.write_image("depth/c.png", depth_of({8, 6}));
  const PluginAnswer opened = with_depth(folder).process(kOpen, {});
  EXPECT_EQ(opened.status, WEFT_ERROR);
  EXPECT_THAT(opened.message, HasSubstr("c.png: belongs to no frame: no image has the stem 'c'"));
}

TEST(Depth, OfTwoFramesWithOneStemIsRefused) {
  const FrameFolder folder;
  fill(folder);
  folder.write_frame("frames/b.bmp");
  auto source = images_source(folder, "frames/*", "depth: '" + folder.path("depth/*.png") + "'");
  const PluginAnswer opened = source.process(kOpen, {});
  EXPECT_EQ(opened.status, WEFT_ERROR);
  EXPECT_THAT(opened.message, HasSubstr("two frames have the stem 'b'"));
}

TEST(Depth, ThatIsNoDepthImageOfTheCameraFailsItsFrame) {
  const FrameFolder folder;
  fill(folder);
  auto source = with_depth(folder);
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  const auto message = [&](const cv::Mat& image) {
    folder.write_image("depth/b.png", image);
    const PluginAnswer read = source.process(kRead, {}, 1);
    EXPECT_EQ(read.status, WEFT_ERROR);
    return read.message;
  };
  EXPECT_THAT(message(depth_of({7, 6})), HasSubstr("b.png: is 7 x 6 px, but"));
  EXPECT_THAT(message(cv::Mat(6, 8, CV_8UC1)), HasSubstr("one channel of 16 bits"));
  EXPECT_THAT(message(cv::Mat(6, 8, CV_16UC3)), HasSubstr("one channel of 16 bits"));
  folder.write("depth/b.png", "no image");
  EXPECT_THAT(source.process(kRead, {}, 1).message, HasSubstr("no image that can be decoded"));
  EXPECT_EQ(source.process(kRead, {}, 0).status, WEFT_OK);
}

}  // namespace
}  // namespace weft::testing
