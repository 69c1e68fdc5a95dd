// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <array>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/image.hpp>
#include <weft/testing/mistakes.hpp>
#include <weft/testing/plugin_under_test.hpp>

#include "common/cameras/tests/frame_folder.hpp"

namespace weft::rotated_film {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using weft::testing::FrameFolder;
using weft::testing::kOpen;
using weft::testing::kRead;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr int kWidth = 64, kHeight = 48;

/// An MP4 of frames with a bright stored top left corner.
std::string film(const FrameFolder& folder) {
  cv::VideoWriter writer(folder.path("plain.mp4"), cv::CAP_FFMPEG,
                         cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 10.0, {kWidth, kHeight});
  cv::Mat frame(kHeight, kWidth, CV_8UC3, cv::Scalar::all(20));
  frame(cv::Rect(0, 0, 16, 16)).setTo(cv::Scalar::all(240));
  for (int i = 0; i < 3; ++i) writer.write(frame);
  writer.release();
  std::ifstream stream(folder.path("plain.mp4"), std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Writes the first two rows of the matrix of the track's header: (a, b) and (c, d), in 1/65536.
std::string turned(std::string bytes, int a, int b, int c, int d) {
  constexpr std::size_t kMatrix = 4 + 40;  // behind the name of the box
  const std::size_t matrix = bytes.find("tkhd") + kMatrix;
  const std::array<std::pair<std::size_t, int>, 4> values{{{0, a}, {4, b}, {12, c}, {16, d}}};
  for (const auto& [at, value] : values) {
    const std::uint32_t number = static_cast<std::uint32_t>(value) << 16U;
    for (std::size_t i = 0; i < 4; ++i) {
      bytes[matrix + at + i] = static_cast<char>(number >> (24U - 8U * i) & 0xFFU);
    }
  }
  return bytes;
}

TEST(RotatedFilm, IsMadeUprightAndTheCameraWithIt) {
  struct Case {
    int a, b, c, d;
    double fx, cx, cy;
    int width, mark_x, mark_y;
  };
  for (const Case& expected : {Case{1, 0, 0, 1, 60, 30, 20, 64, 7, 7},
                               Case{0, 1, -1, 0, 70, 27, 30, 48, 40, 7},     // 90 clockwise
                               Case{-1, 0, 0, -1, 60, 33, 27, 64, 56, 40},   // 180
                               Case{0, -1, 1, 0, 70, 20, 33, 48, 7, 56}}) {  // 90 anticlockwise
    SCOPED_TRACE(expected.mark_x);
    const FrameFolder folder;
    folder.write("film.mp4", turned(film(folder), expected.a, expected.b, expected.c, expected.d));
    folder.write("camera.yaml", "{fx: 60, fy: 70, cx: 30, cy: 20, width: 64, height: 48}");
    PluginUnderTest source("sources/video", "{path: '" + folder.path("film.mp4") + "', camera: '" +
                                                folder.path("camera.yaml") + "'}");
    const PluginAnswer opened = source.process(kOpen, {});
    ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
    const auto camera = *opened.get<weft::Camera>();
    EXPECT_EQ(camera.fx, expected.fx);
    EXPECT_EQ(camera.cx, expected.cx);
    EXPECT_EQ(camera.cy, expected.cy);
    const PluginAnswer frame = source.process(kRead, {}, 1);
    ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
    const auto image = *frame.get<weft::Image>();
    ASSERT_EQ(image.pixels.dim(1), expected.width);
    const auto grey = [&](std::int64_t x, std::int64_t y) {
      return int{image.pixels.data()[(y * image.pixels.dim(1) + x) * 3]};
    };
    EXPECT_GT(grey(expected.mark_x, expected.mark_y), 180);
    EXPECT_LT(grey(24, 24), 80);
  }
}

TEST(RotatedFilm, IsTurnedByTheParameterAfterItsOwnRotation) {
  struct Case {
    int rotation_deg, width, mark_x, mark_y;
  };
  for (const Case& expected :
       {Case{0, 48, 40, 7}, Case{90, 64, 56, 40}, Case{180, 48, 7, 56}, Case{270, 64, 7, 7}}) {
    SCOPED_TRACE(expected.rotation_deg);
    const FrameFolder folder;
    folder.write("film.mp4", turned(film(folder), 0, 1, -1, 0));  // 90 clockwise
    folder.write("camera.yaml", "{fx: 60, fy: 70, cx: 30, cy: 20, width: 64, height: 48}");
    PluginUnderTest source("sources/video", "{path: '" + folder.path("film.mp4") + "', camera: '" +
                                                folder.path("camera.yaml") + "', rotation_deg: " +
                                                std::to_string(expected.rotation_deg) + "}");
    const PluginAnswer opened = source.process(kOpen, {});
    ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
    EXPECT_EQ(opened.get<weft::Camera>()->width_px, expected.width);
    const PluginAnswer frame = source.process(kRead, {}, 1);
    ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
    const auto image = *frame.get<weft::Image>();
    const std::int64_t at = (expected.mark_y * image.pixels.dim(1) + expected.mark_x) * 3;
    EXPECT_GT(int{image.pixels.data()[at]}, 180);
  }
}

TEST(RotatedFilm, NeedsQuarterTurnsAndTheWholeSizeOfADevice) {
  const auto refused = [](const std::string& params) {
    return weft::testing::mistakes_of("sources/video",
                                      "{device: 900, camera: auto, " + params + "}");
  };
  EXPECT_THAT(refused("rotation_deg: 45"), ElementsAre(HasSubstr("give 0, 90, 180 or 270")));
  EXPECT_THAT(refused("width_px: 640"), ElementsAre(HasSubstr("both or none")));
  EXPECT_THAT(refused("format: MJPEG"), ElementsAre(HasSubstr("four characters")));
}

}  // namespace
}  // namespace weft::rotated_film
