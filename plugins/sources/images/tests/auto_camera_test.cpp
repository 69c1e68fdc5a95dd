// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <weft/data/camera.hpp>
#include <weft/data/image.hpp>

#include "common/images/tests/exif.hpp"
#include "images_source.hpp"

namespace weft::auto_camera {
namespace {

using ::testing::HasSubstr;
using weft::testing::FrameFolder;
using weft::testing::images_source;
using weft::testing::jpeg_with_exif;
using weft::testing::kOpen;
using weft::testing::kRead;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

PluginUnderTest source_of(const FrameFolder& folder, const std::string& more = "") {
  return PluginUnderTest("sources/images", "{path: '" + folder.path("frames/*") +
                                               "', camera: auto" +
                                               (more.empty() ? "" : ", " + more) + "}");
}

std::string refusal(PluginUnderTest source) {
  const PluginAnswer opened = source.process(kOpen, {});
  EXPECT_EQ(opened.status, WEFT_ERROR);
  return opened.message;
}

cv::Mat plain(int width, int height, int grey) {
  return {height, width, CV_8UC1, cv::Scalar(grey)};
}

TEST(AutoCamera, TakesTheFocalLengthFromExif) {
  const FrameFolder folder;
  folder.write("frames/0.jpg", jpeg_with_exif(plain(80, 60, 90), {.focal_35mm_mm = 26}));
  PluginUnderTest source = source_of(folder);
  const PluginAnswer opened = source.process(kOpen, {});
  ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
  const auto camera = *opened.get<Camera>();
  EXPECT_DOUBLE_EQ(camera.fx, 26 / 43.27 * 100);
  EXPECT_EQ(camera.cx, 39.5);
  EXPECT_EQ(camera.width_px, 80);
  const auto assumption = CameraAssumption::of(camera);
  ASSERT_TRUE(assumption) << "it goes with the record";
  EXPECT_NEAR(assumption->focal_sd_px, 0.05 * camera.fx, 1e-9);
  EXPECT_THAT(assumption->from, HasSubstr("0.jpg"));
  const PluginAnswer frame = source.process(kRead, {}, 0);
  EXPECT_EQ(frame.status, WEFT_OK) << "what is assumed is told once, not by each frame";
  EXPECT_FALSE(frame.get<Region>().has_value());
}

TEST(AutoCamera, PutsImagesOfSeveralSizesInTheMiddleOfACanvas) {
  const FrameFolder folder;
  folder.write_image("frames/0.png", plain(40, 20, 50));
  folder.write_image("frames/1.png", plain(20, 30, 80));
  PluginUnderTest source = source_of(folder);
  for (int opening = 0; opening < 2; ++opening) {
    const PluginAnswer opened = source.process(kOpen, {});
    ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
    const auto camera = *opened.get<Camera>();
    EXPECT_EQ(camera.width_px, 40);
    EXPECT_EQ(camera.height_px, 30);
    EXPECT_EQ(camera.cx, 19.5);
    EXPECT_EQ(camera.cy, 14.5);
  }
  const PluginAnswer frame = source.process(kRead, {}, 1);
  ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
  const auto image = *frame.get<Image>();
  const auto region = *frame.get<Region>();
  ASSERT_EQ(image.pixels.dim(1), 40);
  for (std::int64_t y = 0; y < 30; ++y) {
    for (std::int64_t x = 0; x < 40; ++x) {
      EXPECT_EQ(image.pixels(y, x), 80) << "its border goes on, without an edge";
      EXPECT_EQ(region.mask(y, x), x >= 10 && x < 30 ? 1 : 0);
    }
  }
}

TEST(AutoCamera, TakesImagesOfSeveralOrientations) {
  const FrameFolder folder;
  folder.write("frames/0.jpg", jpeg_with_exif(plain(80, 60, 90), {.focal_35mm_mm = 26}));
  folder.write("frames/1.jpg",
               jpeg_with_exif(plain(80, 60, 90), {.orientation = 6, .focal_35mm_mm = 26}));
  PluginUnderTest source = source_of(folder);
  const PluginAnswer opened = source.process(kOpen, {});
  ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
  EXPECT_EQ(opened.get<Camera>()->width_px, 80);
  EXPECT_EQ(opened.get<Camera>()->height_px, 80);
  EXPECT_DOUBLE_EQ(opened.get<Camera>()->fx, 26 / 43.27 * 100);
  EXPECT_EQ(source.process(kRead, {}, 1).status, WEFT_OK);
}

TEST(AutoCamera, RefusesWhatBelongsToImagesOfOneSize) {
  const FrameFolder folder;
  folder.write_image("frames/0.png", plain(40, 20, 50));
  folder.write_image("frames/1.png", plain(20, 30, 80));
  folder.write_image("masks/0.png", plain(40, 20, 255));
  folder.write_image("masks/1.png", plain(20, 30, 255));
  EXPECT_THAT(refusal(source_of(folder, "region: '" + folder.path("masks/*.png") + "'")),
              HasSubstr("'region' belongs to images of one size"));
  EXPECT_THAT(refusal(source_of(folder, "wait_s: 1")), HasSubstr("'camera: auto'"));
}

TEST(AutoCamera, WithACameraFileSeveralSizesAreAnErrorOfTheirFrames) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write_frame("frames/0.png");
  folder.write_image("frames/1.png", plain(20, 30, 80));
  PluginUnderTest source = images_source(folder);
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  const PluginAnswer frame = source.process(kRead, {}, 1);
  EXPECT_EQ(frame.status, WEFT_ERROR);
  EXPECT_THAT(frame.message, HasSubstr("describes images of 8 x 6 px"));
}

TEST(ScaledImages, KeepTheRayOfEachPixel) {
  // A ramp whose value is the ray's x: the mean over a pixel is its value in the middle.
  constexpr int kWidth = 90, kHeight = 60;
  const FrameFolder folder;
  cv::Mat ramp(kHeight, kWidth, CV_8UC1);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) ramp.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(2 * x);
  }
  folder.write_image("frames/0.png", ramp);
  folder.write("camera.yaml", "{fx: 100, fy: 110, cx: 40, cy: 33, width: 90, height: 60}");
  for (const int longest : {30, 45, 50, 89}) {
    SCOPED_TRACE(longest);
    PluginUnderTest source =
        images_source(folder, "frames/*.png", "longest_px: " + std::to_string(longest));
    const PluginAnswer opened = source.process(kOpen, {});
    ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
    const auto camera = *opened.get<Camera>();
    EXPECT_EQ(camera.width_px, longest);
    EXPECT_EQ(camera.height_px, std::lround(longest * 2.0 / 3.0));
    const auto image = *source.process(kRead, {}, 0).get<Image>();
    ASSERT_EQ(image.pixels.dim(0), camera.height_px);
    ASSERT_EQ(image.pixels.dim(1), camera.width_px);
    for (std::int64_t x = 1; x + 1 < camera.width_px; ++x) {
      const double ray = (static_cast<double>(x) - camera.cx) / camera.fx;
      EXPECT_NEAR(image.pixels(3, x), 2.0 * (100 * ray + 40), 1.01);
    }
  }
}

TEST(ScaledImages, ASmallImageIsAsItIs) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write_frame("frames/0.png");
  PluginUnderTest source = images_source(folder, "frames/*.png", "longest_px: 8");
  const PluginAnswer opened = source.process(kOpen, {});
  EXPECT_EQ(opened.get<Camera>()->width_px, 8);
  EXPECT_EQ(opened.get<Camera>()->fx, 10);
}

}  // namespace
}  // namespace weft::auto_camera
