// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <opencv2/core.hpp>
#include <stdexcept>
#include <weft/data/camera.hpp>
#include <weft/data/ground_truth.hpp>
#include <weft/data/image.hpp>

#include "common/images/tests/exif.hpp"
#include "encoded_frame.hpp"
#include "images_source.hpp"

namespace weft::orientation_of_frames {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using weft::testing::FrameFolder;
using weft::testing::images_source;
using weft::testing::jpeg_with_orientation;
using weft::testing::kOpen;
using weft::testing::kRead;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr int kWidth = 48, kHeight = 32;

/// A dark image with a bright square at its stored top left corner.
cv::Mat marked() {
  cv::Mat image(kHeight, kWidth, CV_8UC3, cv::Scalar::all(20));
  image(cv::Rect(0, 0, 8, 8)).setTo(cv::Scalar::all(240));
  return image;
}

/// A folder with the camera of the stored images.
struct Frames : FrameFolder {
  Frames() { write("camera.yaml", "{fx: 60, fy: 70, cx: 20, cy: 10, width: 48, height: 32}"); }
  void write_frame_of(int orientation, const std::string& name = "frames/0.jpg") const {
    write(name, jpeg_with_orientation(marked(), orientation));
  }
  PluginUnderTest source(const std::string& more = "") const {
    return images_source(*this, "frames/*.*", more);
  }
  std::string refusal(const std::string& more = "") const {
    PluginUnderTest images = source(more);
    const PluginAnswer opened = images.process(kOpen, {});
    EXPECT_EQ(opened.status, WEFT_ERROR);
    return opened.message;
  }
};

int grey_at(const weft::Image& image, std::int64_t x, std::int64_t y) {
  return image.pixels.data()[(y * image.pixels.dim(1) + x) * 3];
}

TEST(OrientationOfFrames, TurnsTheImageAndTheCameraWithIt) {
  struct Case {
    int orientation;
    double fx, fy, cx, cy;
    int width, height, mark_x, mark_y;  // where the square is
  };
  for (const Case& expected :
       {Case{1, 60, 70, 20, 10, 48, 32, 3, 3}, Case{3, 60, 70, 27, 21, 48, 32, 44, 28},
        Case{6, 70, 60, 21, 20, 32, 48, 28, 3}, Case{8, 70, 60, 10, 27, 32, 48, 3, 44}}) {
    SCOPED_TRACE(expected.orientation);
    const Frames folder;
    folder.write_frame_of(expected.orientation);
    PluginUnderTest source = folder.source();
    const PluginAnswer opened = source.process(kOpen, {});
    ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
    const auto camera = *opened.get<weft::Camera>();
    EXPECT_EQ(camera.fx, expected.fx);
    EXPECT_EQ(camera.fy, expected.fy);
    EXPECT_EQ(camera.cx, expected.cx);
    EXPECT_EQ(camera.cy, expected.cy);
    const PluginAnswer frame = source.process(kRead, {}, 0);
    ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
    const auto image = *frame.get<weft::Image>();
    ASSERT_EQ(image.pixels.dim(1), expected.width);
    ASSERT_EQ(image.pixels.dim(0), expected.height);
    EXPECT_NEAR(grey_at(image, expected.mark_x, expected.mark_y), 240, 8);
    EXPECT_NEAR(grey_at(image, expected.width / 2, expected.height / 2), 20, 8);
  }
}

TEST(OrientationOfFrames, RefusesMixedAndMirroredOnesByName) {
  for (const int mirrored : {2, 4, 5, 7}) {
    const Frames folder;
    folder.write_frame_of(mirrored);
    EXPECT_THAT(folder.refusal(), AllOf(HasSubstr("0.jpg"), HasSubstr("mirrored")));
  }
  const Frames mixed;
  mixed.write_frame_of(6, "frames/0.jpg");
  mixed.write_frame_of(8, "frames/1.jpg");
  EXPECT_THAT(mixed.refusal(), AllOf(HasSubstr("1.jpg"), HasSubstr("0.jpg")));
}

TEST(OrientationOfFrames, TurnsMasksAndDepthWithTheirFrame) {
  for (const bool is_upright : {false, true}) {
    const Frames folder;
    folder.write_frame_of(6);
    cv::Mat mask = cv::Mat::zeros(kHeight, kWidth, CV_8U);
    mask(cv::Rect(0, 0, 8, 8)).setTo(255);
    cv::Mat depth = cv::Mat::zeros(kHeight, kWidth, CV_16U);
    depth(cv::Rect(0, 0, 8, 8)).setTo(500);
    if (is_upright) {
      cv::rotate(mask, mask, cv::ROTATE_90_CLOCKWISE);
      cv::rotate(depth, depth, cv::ROTATE_90_CLOCKWISE);
    }
    folder.write_image("masks/0.png", mask);
    folder.write_image("depth/0.png", depth);
    PluginUnderTest source = folder.source("region: '" + folder.path("masks/*.png") +
                                           "', depth: '" + folder.path("depth/*.png") + "'");
    ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
    const PluginAnswer frame = source.process(kRead, {}, 0);
    ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
    const auto region = *frame.get<weft::Region>();
    const auto truth = *frame.get<weft::GroundTruth>();
    EXPECT_EQ(region.mask(3, 28), 1);
    EXPECT_EQ(region.mask(3, 3), 0);
    EXPECT_FLOAT_EQ(truth.depth_m(3, 28), 0.5F);
    EXPECT_FLOAT_EQ(truth.depth_m(3, 3), 0.0F);
  }
}

TEST(OrientationOfFrames, RefusesAMaskWhoseOrientationNothingShows) {
  const Frames folder;
  folder.write_frame_of(3);
  folder.write_image("masks/0.png", cv::Mat::ones(kHeight, kWidth, CV_8U));
  PluginUnderTest source = folder.source("region: '" + folder.path("masks/*.png") + "'");
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  const PluginAnswer frame = source.process(kRead, {}, 0);
  EXPECT_EQ(frame.status, WEFT_ERROR);
  EXPECT_THAT(frame.message, HasSubstr("masks/0.png"));
}

TEST(OrientationOfFrames, RefusesTruthBesideACameraThatIsRotated) {
  const Frames folder;
  folder.write_frame_of(6);
  folder.write(
      "gt/0.csv",
      "point_id,template_x_mm,template_y_mm,u_px,v_px,X_mm,Y_mm,Z_mm\n0,0,0,1,1,0,0,500\n");
  EXPECT_THAT(folder.refusal("truth: '" + folder.path("gt/*.csv") + "'"),
              AllOf(HasSubstr("'truth'"), HasSubstr("upright")));
}

TEST(FilesOfFrames, RefusesImagesOfMoreThan8BitsBeforeTheFirstFrame) {
  const Frames folder;
  for (const char* name : {"frames/0.png", "frames/1.png"}) {
    folder.write_image(name, cv::Mat::zeros(kHeight, kWidth, CV_16UC1));
  }
  EXPECT_THAT(folder.refusal(), AllOf(HasSubstr("0.png"), HasSubstr("8 bits")));
}

TEST(FilesOfFrames, HintsAtAWildcardForANumberingOfAnotherProgram) {
  const Frames folder;
  folder.write_image("frames/img_0001.png", marked());
  EXPECT_THAT([&] { images_source(folder, "frames/img_%04d.png"); },
              ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("/img_*.png'")));
}

TEST(FilesOfFrames, ADamagedJpegIsADegenerateFrameWithTheDecodersReason) {
  const Frames folder;
  cv::Mat detailed = marked();
  for (int i = 0; i < kWidth * kHeight; i += 3) detailed.data[3 * i] = std::uint8_t(37 * i);
  std::string bytes = jpeg_with_orientation(detailed, 1);
  const std::size_t scan = bytes.find("\xFF\xDA") + 14;
  folder.write("frames/0.jpg", bytes);
  for (std::size_t i = scan + 10; i < scan + 40; ++i) bytes[i] = '\x7F';
  folder.write("frames/1.jpg", bytes);
  ::testing::internal::CaptureStderr();
  PluginUnderTest source = folder.source();
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  EXPECT_EQ(source.process(kRead, {}, 0).status, WEFT_OK);
  const PluginAnswer damaged = source.process(kRead, {}, 1);
  EXPECT_EQ(damaged.status, WEFT_DEGENERATE);
  EXPECT_THAT(damaged.message, AllOf(HasSubstr("1.jpg"), HasSubstr("Corrupt JPEG data")));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace weft::orientation_of_frames
