// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/image.hpp>
#include <weft/testing/plugin_under_test.hpp>

#include "common/cameras/tests/frame_folder.hpp"

namespace weft::damaged_film {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using weft::testing::FrameFolder;
using weft::testing::kOpen;
using weft::testing::kRead;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr int kWidth = 64, kHeight = 48, kFrames = 24, kStep = 10;  // grey levels between frames

/// A Motion JPEG whose frames have one grey level each, and sources on it.
class DamagedFilm : public ::testing::Test {
 protected:
  DamagedFilm() {
    folder_.write("camera.yaml", "{fx: 60, fy: 60, cx: 31.5, cy: 23.5, width: 64, height: 48}");
    cv::VideoWriter writer(folder_.path("film.avi"), cv::CAP_OPENCV_MJPEG,
                           cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0, {kWidth, kHeight});
    for (int i = 0; i < kFrames; ++i) {
      cv::Mat frame(kHeight, kWidth, CV_8UC3, cv::Scalar::all(kStep * i));
      frame.col(0).setTo(cv::Scalar::all(255));
      writer.write(frame);
    }
    writer.release();
    std::ifstream stream(folder_.path("film.avi"), std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(stream), {});
    for (std::size_t at = bytes_.find("\xFF\xD8\xFF"); at != bytes_.npos;
         at = bytes_.find("\xFF\xD8\xFF", at + 1)) {
      images_.push_back(at);
    }
    EXPECT_EQ(images_.size(), std::size_t{kFrames});
  }

  /// Makes the header of a frame one that no decoder takes.
  void spoil(int frame) {
    const std::size_t at = bytes_.find("\xFF\xC0", images_[static_cast<std::size_t>(frame)]);
    bytes_[at + 1] = '\xC6';
  }

  /// Reads all frames; checks the grey level of those that are whole. Returns the messages of the
  /// degenerate ones by their numbers.
  std::map<int, std::string> degenerate_frames() {
    folder_.write("spoilt.avi", bytes_);
    ::testing::internal::CaptureStderr();
    PluginUnderTest source("sources/video", "{path: '" + folder_.path("spoilt.avi") +
                                                "', camera: '" + folder_.path("camera.yaml") +
                                                "'}");
    const PluginAnswer opened = source.process(kOpen, {});
    EXPECT_EQ(opened.status, WEFT_OK) << opened.message;
    std::map<int, std::string> found;
    int count = 0;
    for (;; ++count) {
      const PluginAnswer frame = source.process(kRead, {}, static_cast<std::uint64_t>(count));
      if (frame.status == WEFT_END) break;
      EXPECT_TRUE(frame.status == WEFT_OK || frame.status == WEFT_DEGENERATE) << frame.message;
      if (count > 2 * kFrames) break;
      if (frame.status == WEFT_DEGENERATE) {
        found[count] = frame.message;
      } else {
        const auto image = frame.get<weft::Image>();
        const int grey = image->pixels.data()[(kHeight / 2 * kWidth + kWidth / 2) * 3];
        EXPECT_NEAR(grey, kStep * count, 3) << count;
      }
    }
    EXPECT_EQ(count, kFrames);
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), IsEmpty());
    return found;
  }

  FrameFolder folder_;
  std::string bytes_;
  std::vector<std::size_t> images_;
};

TEST_F(DamagedFilm, AFrameThatTheDecoderRefusesCostsItselfAlone) {
  spoil(8);
  const auto found = degenerate_frames();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found.at(8), AllOf(HasSubstr("spoilt.avi"), HasSubstr("frame 8 cannot be decoded")));
}

TEST_F(DamagedFilm, ManyInARowAndTheFirstAndTheLastCostThemselvesAlone) {
  for (const int frame : {0, 5, 6, 7, 8, 9, 10, 22, 23}) spoil(frame);
  const auto found = degenerate_frames();
  EXPECT_EQ(found.size(), 9U);
  for (const int frame : {0, 5, 6, 7, 8, 9, 10, 22, 23}) EXPECT_EQ(found.count(frame), 1U) << frame;
}

TEST_F(DamagedFilm, AFrameWithDamagedCodeIsDegenerateWithTheDecodersReason) {
  const std::size_t scan = bytes_.find("\xFF\xDA", images_[12]);
  ASSERT_LT(scan, images_[13]);
  for (std::size_t i = scan + 20; i < scan + 60; ++i) bytes_[i] = '\x7F';
  const auto found = degenerate_frames();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found.at(12), AllOf(HasSubstr("frame 12"), HasSubstr("Corrupt JPEG data")));
}

TEST_F(DamagedFilm, AWholeOneHasNoDegenerateFrames) { EXPECT_THAT(degenerate_frames(), IsEmpty()); }

}  // namespace
}  // namespace weft::damaged_film
