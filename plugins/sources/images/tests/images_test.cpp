// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <opencv2/imgproc.hpp>
#include <weft/data/image.hpp>

#include "common/cameras/calibrated_camera.hpp"
#include "images_source.hpp"

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using weft::testing::FrameFolder;
using weft::testing::images_source;
using weft::testing::kCount;
using weft::testing::kOpen;
using weft::testing::kRead;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

std::int64_t opened_count(PluginUnderTest& source) {
  const PluginAnswer opened = source.process(kOpen, {});
  EXPECT_EQ(opened.status, WEFT_OK) << opened.message;
  return source.process(kCount, {}).get<weft::Count>()->frames;
}

/// A pattern in which no two neighbours are alike.
void fill(cv::Mat& image) {
  for (std::uint8_t* value = image.data; value < image.dataend; ++value) {
    *value = static_cast<std::uint8_t>((value - image.data) * 2654435761U >> 24U);
  }
}

/// The message with which open() fails.
std::string refusal(PluginUnderTest source) {
  const PluginAnswer opened = source.process(kOpen, {});
  EXPECT_EQ(opened.status, WEFT_ERROR);
  return opened.message;
}

TEST(ImagesSource, GivesFramesInNaturalOrderWithTheirTime) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write_frame("frames/b10.png", 4);
  folder.write_frame("frames/b9.png", 3);
  folder.write_frame("frames/B11.png", 1);
  folder.write_frame("frames/a.png", 2);
  folder.write_frame("frames/.hidden.png", 9);
  folder.write("frames/notes.txt", "no image");
  PluginUnderTest source = images_source(folder, "frames/*.png", "fps: 25");
  ASSERT_EQ(opened_count(source), 4);
  const std::vector<std::string> stems{"B11", "a", "b9", "b10"};
  for (std::uint64_t i = 0; i < 4; ++i) {
    const PluginAnswer frame = source.process(kRead, {}, i);
    ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
    const auto image = frame.get<weft::Image>();
    EXPECT_EQ(image->stem, stems[i]);
    EXPECT_EQ(image->pixels(0, 0), i + 1);
    EXPECT_DOUBLE_EQ(frame.get<weft::Time>()->t_s, static_cast<double>(i) / 25.0);
    EXPECT_FALSE(frame.get<weft::GroundTruth>().has_value());
  }
}

TEST(ImagesSource, MatchesPatternsInFoldersToo) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write_frame("run1/left/0.png");
  folder.write_frame("run2/left/1.png");
  folder.write_frame("run3/left/2.png");
  folder.write_frame("run2/right/3.png");
  PluginUnderTest source = images_source(folder, "run[12]/l?ft/*.png");
  EXPECT_EQ(opened_count(source), 2);
}

TEST(ImagesSource, LeavesOutWhatWeftHasNotFinished) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write_frame("frames/0.png");
  std::ofstream(folder.path("frames/1.png.0123456789ab.part")) << "begun";
  PluginUnderTest source = images_source(folder, "frames/*");
  EXPECT_EQ(opened_count(source), 1);
  std::ofstream(folder.path("frames/1.png.part")) << "of another program";
  PluginUnderTest other = images_source(folder, "frames/*");
  EXPECT_EQ(opened_count(other), 2) << "a name that Weft does not write is a frame";
}

TEST(ImagesSource, TakesAFolderWithBracketsInItsNameAsItIs) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write_frame("[2024]/0.png");
  folder.write_frame("2/0.png");
  PluginUnderTest source = images_source(folder, "[2024]/*.png");
  ASSERT_EQ(opened_count(source), 1);
}

TEST(ImagesSource, ReadsOneImageWithoutAPattern) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write_frame("only.png");
  PluginUnderTest source = images_source(folder, "only.png");
  EXPECT_EQ(opened_count(source), 1);
}

TEST(ImagesSource, KeepsPixelsAndChannelsOfAnIdealCamera) {
  const FrameFolder folder;
  folder.write_camera();
  cv::Mat grey(6, 8, CV_8UC1), colour(6, 8, CV_8UC3), transparent(6, 8, CV_8UC4);
  fill(grey);
  fill(colour);
  fill(transparent);
  folder.write_image("frames/0.png", grey);
  folder.write_image("frames/1.png", colour);
  folder.write_image("frames/2.png", transparent);
  PluginUnderTest source = images_source(folder);
  ASSERT_EQ(opened_count(source), 3);
  cv::cvtColor(transparent, transparent, cv::COLOR_BGRA2BGR);
  const std::vector<cv::Mat> expected{grey, colour, transparent};
  for (std::uint64_t i = 0; i < 3; ++i) {
    const auto image = source.process(kRead, {}, i).get<weft::Image>();
    ASSERT_TRUE(image.has_value());
    EXPECT_EQ(image->pixels.ndim(), i == 0 ? 2 : 3);
    EXPECT_TRUE(std::equal(expected[i].datastart, expected[i].dataend, image->pixels.data()));
  }
}

TEST(ImagesSource, AFrameThatCannotBeUsedIsAnErrorOfThatFrameOnly) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write_frame("frames/0.png");
  folder.write("frames/1.png", "this is text");
  folder.write("frames/2.png", "");
  folder.write_image("frames/3.png", cv::Mat::zeros(5, 7, CV_8UC3));
  folder.write_image("frames/4.png", cv::Mat::zeros(6, 8, CV_16UC1));
  cv::Mat noise(6, 8, CV_8UC3);
  fill(noise);
  std::vector<std::uint8_t> png;
  cv::imencode(".png", noise, png);
  folder.write("frames/5.png", {png.begin(), png.begin() + 90});
  folder.write_frame("frames/6.png");
  PluginUnderTest source = images_source(folder);
  ASSERT_EQ(opened_count(source), 7);
  const std::vector<std::vector<std::string>> expected{{},
                                                       {"1.png", "no image"},
                                                       {"2.png", "empty"},
                                                       {"3.png", "7 x 5", "8 x 6", "camera.yaml"},
                                                       {"4.png", "8 bits"},
                                                       {"5.png", "damaged"},
                                                       {}};
  for (std::uint64_t i = 0; i < 7; ++i) {
    const PluginAnswer frame = source.process(kRead, {}, i);
    EXPECT_EQ(frame.status, expected[i].empty() ? WEFT_OK : WEFT_ERROR) << i;
    for (const std::string& part : expected[i]) EXPECT_THAT(frame.message, HasSubstr(part));
  }
}

TEST(ImagesSource, AFrameBeyondTheLastIsAnError) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write_frame("frames/0.png");
  PluginUnderTest source = images_source(folder);
  ASSERT_EQ(opened_count(source), 1);
  const PluginAnswer frame = source.process(kRead, {}, 1);
  EXPECT_EQ(frame.status, WEFT_ERROR);
  EXPECT_THAT(frame.message, HasSubstr("no frame 1"));
}

TEST(ImagesSource, NamesThePatternThatMatchesNothingAndWhy) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write_frame("frames/0.png");
  EXPECT_THAT(refusal(images_source(folder, "frames/*.jpg")),
              AllOf(HasSubstr("frames/*.jpg"), HasSubstr("no such file")));
  EXPECT_THAT(refusal(images_source(folder, "farmes/*.png")),
              AllOf(HasSubstr("farmes/*.png"), HasSubstr("does not exist")));
  EXPECT_THAT(refusal(images_source(folder, "frames")), HasSubstr("is a folder"));
  std::filesystem::create_directories(folder.path("empty"));
  EXPECT_THAT(refusal(images_source(folder, "empty/*")), HasSubstr("no file matches"));
}

TEST(ImagesSource, RefusesAMissingCameraFileBeforeAnythingElse) {
  const FrameFolder folder;
  folder.write_frame("frames/0.png");
  EXPECT_THROW(images_source(folder), std::runtime_error);
}

TEST(ImagesSource, GivesImagesWithoutTheDistortionOfTheCamera) {
  const FrameFolder folder;
  folder.write("camera.yaml",
               "{fx: 10, fy: 11, cx: 3.5, cy: 2.5, width: 8, height: 6, "
               "distortion: [-0.3, 0.1, 0, 0, 0]}");
  cv::Mat noise(6, 8, CV_8UC3);
  fill(noise);
  folder.write_image("frames/0.png", noise);
  PluginUnderTest source = images_source(folder);
  ASSERT_EQ(opened_count(source), 1);
  const auto image = source.process(kRead, {}).get<weft::Image>();
  const auto camera = weft::cameras::CalibratedCamera::read(folder.path("camera.yaml"));
  const auto expected = camera->undistorted(noise, "0.png", "0");
  const std::uint8_t* pixels = expected->pixels.data();
  EXPECT_TRUE(std::equal(pixels, pixels + expected->pixels.size(), image->pixels.data()));
  EXPECT_FALSE(std::equal(noise.datastart, noise.dataend, pixels)) << "the lens is too weak";
}

TEST(ImagesSource, ReadsTheKinectPaperSequence) {
  const char* data = std::getenv("WEFT_DATA");
  if (data == nullptr) GTEST_SKIP() << "WEFT_DATA is not set";
  const std::string folder = std::string(data) + "/kinect_paper";
  PluginUnderTest source("sources/images", "{path: '" + folder + "/frames/*.png', camera: '" +
                                               folder + "/K.json', truth: '" + folder +
                                               "/gt/*.csv', excluded: {\"009\": texture source}}");
  ASSERT_EQ(opened_count(source), 100);
  int with_truth = 0, excluded = 0;
  for (std::uint64_t i = 0; i < 100; ++i) {
    const PluginAnswer frame = source.process(kRead, {}, i);
    ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
    const auto truth = frame.get<weft::GroundTruth>();
    if (!truth) continue;
    ++with_truth;
    EXPECT_EQ(truth->count(), truth->kind == "mdh301" ? 301 : 90);
    if (!truth->exclusion.empty()) {
      ++excluded;
      EXPECT_EQ(frame.get<weft::Image>()->stem, "009");
    }
  }
  EXPECT_EQ(with_truth, 17);
  EXPECT_EQ(excluded, 1);
}

}  // namespace
