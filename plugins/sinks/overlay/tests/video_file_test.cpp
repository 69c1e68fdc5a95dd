// SPDX-License-Identifier: Apache-2.0
#include "video_file.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <opencv2/videoio.hpp>

namespace {

namespace fs = std::filesystem;

TEST(VideoFile, GoesOnInAnotherFileBeforeAnAviBecomesTooLarge) {
  std::string folder = (fs::temp_directory_path() / "weft_XXXXXX").string();
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  cv::Mat picture(120, 160, CV_8UC3);
  for (std::uint8_t* value = picture.data; value < picture.dataend; ++value) {
    *value = static_cast<std::uint8_t>((value - picture.data) * 2654435761U >> 24U);
  }
  weft::overlay::VideoFile video(100'000);
  ASSERT_TRUE(video.open(folder + "/long.avi", 30.0, picture.size()));
  constexpr int kFrames = 40;
  for (int i = 0; i < kFrames; ++i) ASSERT_TRUE(video.write(picture));
  ASSERT_TRUE(video.close());

  int parts = 0, frames = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    ++parts;
    cv::VideoCapture capture(entry.path().string(), cv::CAP_FFMPEG);
    while (capture.isOpened() && capture.grab()) ++frames;
  }
  EXPECT_GE(parts, 3);
  EXPECT_EQ(frames, kFrames);
  EXPECT_TRUE(fs::exists(folder + "/long_2.avi"));
  fs::remove_all(folder);
}

TEST(VideoFile, GoesOnOverNoOtherFile) {
  std::string folder = (fs::temp_directory_path() / "weft_XXXXXX").string();
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  std::ofstream(folder + "/long_2.avi") << "precious";
  const cv::Mat picture(120, 160, CV_8UC3, cv::Scalar(1, 2, 3));
  weft::overlay::VideoFile video(1000);
  ASSERT_TRUE(video.open(folder + "/long.avi", 30.0, picture.size()));
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(video.write(picture));
  ASSERT_TRUE(video.close());
  EXPECT_EQ(fs::file_size(folder + "/long_2.avi"), 8U);
  EXPECT_TRUE(fs::exists(folder + "/long_3.avi"));
  fs::remove_all(folder);
}

}  // namespace
