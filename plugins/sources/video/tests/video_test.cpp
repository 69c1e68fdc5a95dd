// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <thread>
#include <weft/core/rng.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/image.hpp>
#include <weft/testing/plugin_under_test.hpp>

#include "common/cameras/tests/frame_folder.hpp"

namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using weft::testing::FrameFolder;
using weft::testing::kCount;
using weft::testing::kOpen;
using weft::testing::kRead;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr int kWidth = 64, kHeight = 48, kBits = 8, kFrames = 40;
constexpr double kFps = 10.0;

/// Stripes, black or white, which are the bits of the number.
cv::Mat numbered(int number) {
  cv::Mat image(kHeight, kWidth, CV_8UC3, cv::Scalar::all(0));
  for (int bit = 0; bit < kBits; ++bit) {
    if (((number >> bit) & 1) == 0) continue;
    image.colRange(bit * kWidth / kBits, (bit + 1) * kWidth / kBits) = cv::Scalar::all(255);
  }
  return image;
}

int number_in(const weft::Image& image) {
  int number = 0;
  for (int bit = 0; bit < kBits; ++bit) {
    const std::int64_t column = (2 * bit + 1) * kWidth / (2 * kBits);
    if (image.pixels.data()[(kHeight / 2 * kWidth + column) * 3] > 127) number |= 1 << bit;
  }
  return number;
}

void write_video(const std::string& path, int frames = kFrames, int backend = cv::CAP_OPENCV_MJPEG,
                 const std::string& codec = "MJPG") {
  cv::VideoWriter writer(path, backend,
                         cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]), kFps,
                         cv::Size(kWidth, kHeight));
  ASSERT_TRUE(writer.isOpened()) << path;
  for (int i = 0; i < frames; ++i) writer.write(numbered(i));
}

struct OpenedSource : PluginUnderTest {
  explicit OpenedSource(const std::string& params) : PluginUnderTest("sources/video", params) {
    const PluginAnswer opened = process(kOpen, {});
    EXPECT_EQ(opened.status, WEFT_OK) << opened.message;
    EXPECT_EQ(process(kCount, {}).get<weft::Count>()->frames, -1);
    EXPECT_EQ(process(kCount, {}).get<weft::Count>()->live, 0) << "a file waits";
  }
};

/// A folder with a camera file, and sources on its videos.
class VideoSource : public ::testing::Test {
 protected:
  VideoSource() { write_camera(kWidth, "null"); }

  void write_camera(int width, const std::string& distortion) {
    folder_.write("camera.yaml",
                  "{fx: 60, fy: 60, cx: 31.5, cy: 23.5, width: " + std::to_string(width) +
                      ", height: 48, distortion: " + distortion + "}");
  }

  std::string params(const std::string& more) const {
    return "{camera: '" + folder_.path("camera.yaml") + "', " + more + "}";
  }
  OpenedSource opened(const std::string& file, const std::string& more = "") const {
    return OpenedSource(params("path: '" + folder_.path(file) + "'" + more));
  }
  std::string refusal(const std::string& more) const {
    PluginUnderTest source("sources/video", params(more));
    const PluginAnswer outcome = source.process(kOpen, {});
    EXPECT_EQ(outcome.status, WEFT_ERROR) << more;
    return outcome.message;
  }
  std::string refusal_of_file(const std::string& file, const std::string& more = "") const {
    return refusal("path: '" + folder_.path(file) + "'" + more);
  }

  std::string content(const std::string& file) const {
    std::ifstream stream(folder_.path(file), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  FrameFolder folder_;
};

/// The numbers in the frames, until there are no more.
std::vector<int> numbers(PluginUnderTest& source) {
  std::vector<int> found;
  for (std::uint64_t i = 0; i < 2 * kFrames; ++i) {
    const PluginAnswer frame = source.process(kRead, {}, i);
    if (frame.status == WEFT_END) break;
    EXPECT_EQ(frame.status, WEFT_OK) << frame.message;
    found.push_back(number_in(*frame.get<weft::Image>()));
  }
  return found;
}

TEST_F(VideoSource, GivesEachFrameOnceAndThenItsEnd) {
  write_video(folder_.path("clip.avi"));
  OpenedSource source = opened("clip.avi");
  for (int i = 0; i < kFrames; ++i) {
    const PluginAnswer frame = source.process(kRead, {}, static_cast<std::uint64_t>(i));
    ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
    const auto image = frame.get<weft::Image>();
    EXPECT_THAT(std::vector<std::int64_t>({image->pixels.rows(), image->pixels.size()}),
                ElementsAre(kHeight, kHeight * kWidth * 3));
    EXPECT_EQ(number_in(*image), i);
    EXPECT_EQ(image->stem, (i < 10 ? "clip_00000" : "clip_0000") + std::to_string(i));
    EXPECT_NEAR(frame.get<weft::Time>()->t_s, i / kFps, 1e-9);
    EXPECT_FALSE(frame.get<weft::GroundTruth>().has_value());
  }
  for (std::uint64_t i : {kFrames, kFrames, kFrames + 100}) {
    EXPECT_EQ(source.process(kRead, {}, i).status, WEFT_END);
  }
}

/// Frames in random order, past the end too, against the frames in order.
void expect_same_in_any_order(OpenedSource source, OpenedSource shuffled) {
  std::vector<PluginAnswer> in_order;
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    in_order.push_back(source.process(kRead, {}, i));
    ASSERT_EQ(number_in(*in_order.back().get<weft::Image>()), static_cast<int>(i));
  }
  constexpr std::uint64_t kSeed = 5;
  SCOPED_TRACE(kSeed);
  weft::Rng rng(kSeed);
  for (int draw = 0; draw < 60; ++draw) {
    const auto i = rng.below(kFrames + 3);
    const PluginAnswer frame = shuffled.process(kRead, {}, i);
    ASSERT_EQ(frame.status, i < kFrames ? WEFT_OK : WEFT_END) << i << frame.message;
    if (i >= kFrames) continue;
    const auto image = frame.get<weft::Image>(), expected = in_order[i].get<weft::Image>();
    EXPECT_TRUE(std::equal(image->pixels.data(), image->pixels.data() + image->pixels.size(),
                           expected->pixels.data()))
        << i;
    EXPECT_EQ(image->stem, expected->stem);
    EXPECT_EQ(frame.get<weft::Time>()->t_s, in_order[i].get<weft::Time>()->t_s);
  }
}

TEST_F(VideoSource, GivesTheSameFramesInAnyOrder) {
  write_video(folder_.path("clip.avi"));
  expect_same_in_any_order(opened("clip.avi"), opened("clip.avi"));
}

TEST_F(VideoSource, GivesTheSameFramesInAnyOrderWhereTheyDependOnEachOther) {
  write_video(folder_.path("clip.mp4"), kFrames, cv::CAP_FFMPEG, "mp4v");
  expect_same_in_any_order(opened("clip.mp4"), opened("clip.mp4"));
}

TEST_F(VideoSource, TakesTheTimesOfTheContainer) {
  write_video(folder_.path("even.mkv"), 4, cv::CAP_FFMPEG);
  // A block of Matroska: track 1, two bytes of time in ms, flags; then the JPEG image.
  std::string bytes = content("even.mkv");
  const std::vector<int> times_ms{0, 30, 250, 251};
  std::size_t block = 0;
  for (const int time_ms : times_ms) {
    block = bytes.find("\xFF\xD8\xFF", block + 1);
    ASSERT_NE(block, bytes.npos);
    ASSERT_EQ(bytes[block - 4], '\x81');
    bytes[block - 3] = static_cast<char>(time_ms >> 8);
    bytes[block - 2] = static_cast<char>(time_ms & 0xFF);
  }
  folder_.write("uneven.mkv", bytes);
  OpenedSource source = opened("uneven.mkv");
  for (std::uint64_t i = 0; i < times_ms.size(); ++i) {
    const PluginAnswer frame = source.process(kRead, {}, i);
    ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
    EXPECT_NEAR(frame.get<weft::Time>()->t_s, times_ms[i] * 1e-3, 1e-9);
    EXPECT_EQ(number_in(*frame.get<weft::Image>()), static_cast<int>(i));
  }
}

TEST_F(VideoSource, SkipsTheStartTakesEveryStepThFrameAndStops) {
  write_video(folder_.path("clip.avi"));
  OpenedSource some = opened("clip.avi", ", start_s: 1, step: 7, max_frames: 3");
  const PluginAnswer second = some.process(kRead, {}, 1);
  EXPECT_NEAR(second.get<weft::Time>()->t_s, 7 / kFps, 1e-9);
  EXPECT_EQ(second.get<weft::Image>()->stem, "clip_000017");
  EXPECT_THAT(numbers(some), ElementsAre(10, 17, 24));
  OpenedSource late = opened("clip.avi", ", start_s: 1.001, step: 10");
  EXPECT_THAT(numbers(late), ElementsAre(11, 21, 31));
  EXPECT_THAT(numbers(late), ElementsAre(11, 21, 31));
}

TEST_F(VideoSource, RemovesTheDistortionOfTheLens) {
  write_video(folder_.path("clip.avi"));
  const auto white = [&](const std::string& distortion) {
    write_camera(kWidth, distortion);
    const PluginAnswer frame = opened("clip.avi").process(kRead, {}, 0b11);
    const auto image = *frame.get<weft::Image>();
    std::int64_t count = 0;
    for (std::int64_t u = 0; u < kWidth; ++u) {
      count += image.pixels.data()[(kHeight / 2 * kWidth + u) * 3] > 127 ? 1 : 0;
    }
    return count;
  };
  EXPECT_EQ(white("null"), kWidth / 4);
  // The edge at 15.5 px is x = -16/60 in the distorted image: x (1 + 0.5 x^2) there is x = -0.2580,
  // which is 16.0 px. The left border of the image, -31.5/60, comes from x = -0.4722, 3.2 px.
  EXPECT_NEAR(static_cast<double>(white("[0.5, 0, 0, 0, 0]")), 13.0, 1.0);
}

TEST_F(VideoSource, WithoutACameraFileTheFocalLengthIsGuessedAndEachFrameSaysSo) {
  write_video(folder_.path("clip.avi"));
  PluginUnderTest source("sources/video", "{path: '" + folder_.path("clip.avi") + "'}");
  const PluginAnswer opened = source.process(kOpen, {});
  ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
  const auto camera = *opened.get<weft::Camera>();
  EXPECT_EQ(camera.fx, kWidth);
  EXPECT_EQ(camera.fy, kWidth);
  EXPECT_EQ(camera.cx, 31.5);
  EXPECT_EQ(camera.cy, 23.5);
  const PluginAnswer frame = source.process(kRead, {}, 3);
  EXPECT_EQ(frame.status, WEFT_DEGENERATE);
  EXPECT_THAT(frame.message, HasSubstr("not calibrated"));
  EXPECT_EQ(number_in(*frame.get<weft::Image>()), 3);
}

TEST_F(VideoSource, AnAssumedCameraIsTheSameAndItsFramesAreInOrder) {
  write_video(folder_.path("clip.avi"));
  PluginUnderTest source("sources/video",
                         "{path: '" + folder_.path("clip.avi") + "', camera: auto}");
  const PluginAnswer opened = source.process(kOpen, {});
  ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
  EXPECT_EQ(opened.get<weft::Camera>()->fx, kWidth);
  const auto assumption = weft::CameraAssumption::of(*opened.get<weft::Camera>());
  ASSERT_TRUE(assumption);
  EXPECT_DOUBLE_EQ(assumption->focal_sd_px, 0.25 * kWidth);
  EXPECT_EQ(source.process(kRead, {}, 3).status, WEFT_OK);
}

TEST_F(VideoSource, ScalesFramesAndCameraAlike) {
  write_video(folder_.path("clip.avi"));

  OpenedSource source = opened("clip.avi", ", longest_px: " + std::to_string(kWidth / 2));
  const PluginAnswer frame = source.process(kRead, {}, 3);
  ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
  EXPECT_EQ(frame.get<weft::Image>()->pixels.dim(1), kWidth / 2);
  EXPECT_EQ(frame.get<weft::Image>()->pixels.dim(0), kHeight / 2);
}

TEST_F(VideoSource, RefusesWhatIsNoVideo) {
  EXPECT_THROW(opened("missing.avi"), std::runtime_error);
  folder_.write("empty.avi", "");
  folder_.write("text.avi", "this is no video");
  folder_.write("folder/a.txt", "");
  write_video(folder_.path("clip.mp4"), kFrames, cv::CAP_FFMPEG, "mp4v");
  folder_.write("half.mp4", content("clip.mp4").substr(0, content("clip.mp4").size() / 2));
  EXPECT_THAT(refusal_of_file("empty.avi"), AllOf(HasSubstr("empty.avi"), HasSubstr("no video")));
  EXPECT_THAT(refusal_of_file("text.avi"), HasSubstr("no video"));
  EXPECT_THAT(refusal_of_file("half.mp4"), HasSubstr("no video"));
  EXPECT_THAT(refusal_of_file("folder"), HasSubstr("folder"));
  write_video(folder_.path("none.avi"), 0);
  EXPECT_THAT(refusal_of_file("none.avi"), AllOf(HasSubstr("none.avi"), HasSubstr("no frame")));
}

TEST_F(VideoSource, RefusesParametersThatDoNotFitTheVideo) {
  write_video(folder_.path("clip.avi"));
  EXPECT_THAT(refusal_of_file("clip.avi", ", start_s: 4"),
              AllOf(HasSubstr("'start_s'"), HasSubstr("3.900 s")));
  EXPECT_THAT(refusal("step: 2"), HasSubstr("give one of 'path', 'device'"));
  EXPECT_THAT(refusal_of_file("clip.avi", ", device: 0"),
              HasSubstr("give one of 'path', 'device'"));
  write_camera(kWidth + 1, "null");
  EXPECT_THAT(refusal_of_file("clip.avi"),
              AllOf(HasSubstr("clip.avi"), HasSubstr("64 x 48"), HasSubstr("65 x 48")));
}

TEST_F(VideoSource, AVideoThatWasCutOffIsAnErrorOfTheFirstMissingFrameOnly) {
  write_video(folder_.path("clip.avi"));
  folder_.write("half.avi", content("clip.avi").substr(0, content("clip.avi").size() / 2));
  OpenedSource source = opened("half.avi");
  std::uint64_t end = 0;
  for (std::int32_t status = WEFT_OK; status == WEFT_OK || status == WEFT_DEGENERATE;) {
    status = source.process(kRead, {}, end).status;  // the last one may be half a frame
    end += status == WEFT_OK || status == WEFT_DEGENERATE ? 1 : 0;
  }
  EXPECT_GT(end, 10U);
  EXPECT_LT(end, 25U);
  for (int repeat = 0; repeat < 2; ++repeat) {
    const PluginAnswer missing = source.process(kRead, {}, end);
    EXPECT_EQ(missing.status, WEFT_ERROR);
    EXPECT_THAT(missing.message, AllOf(HasSubstr("half.avi"), HasSubstr("4.000 s")));
    EXPECT_EQ(source.process(kRead, {}, end + 1).status, WEFT_END);
    EXPECT_EQ(source.process(kRead, {}, 0).status, WEFT_OK);
  }
}

TEST_F(VideoSource, ReadsAVideoWhoseWriterWasKilledAsFarAsItGoes) {
  write_video(folder_.path("clip.avi"));
  std::string bytes = content("clip.avi");
  // The writer fills in the numbers of frames at the end.
  bytes.replace(bytes.find("avih") + 8 + 16, 4, 4, '\0');
  bytes.replace(bytes.find("strh") + 8 + 32, 4, 4, '\0');
  folder_.write("killed.avi", bytes.substr(0, bytes.size() / 2));
  OpenedSource source = opened("killed.avi");
  std::vector<int> found;
  for (std::uint64_t i = 0;; ++i) {
    const PluginAnswer frame = source.process(kRead, {}, i);
    if (frame.status == WEFT_END) break;
    ASSERT_TRUE(frame.status == WEFT_OK || frame.status == WEFT_DEGENERATE) << frame.message;
    found.push_back(number_in(*frame.get<weft::Image>()));
  }
  ASSERT_GT(found.size(), 10U);
  std::vector<int> expected(found.size());
  std::iota(expected.begin(), expected.end(), 0);
  EXPECT_EQ(std::vector<int>(found.begin(), found.end() - 1),
            std::vector<int>(expected.begin(), expected.end() - 1))  // the last may be half a frame
      << "of " << found.size();
}

TEST_F(VideoSource, ACameraThatIsNotThereIsAnErrorThatSaysSo) {
  EXPECT_THAT(refusal("device: 1023"), AllOf(HasSubstr("/dev/video1023"), HasSubstr("'device'")));
}

/// Numbered frames as a camera's program writes them into a pipe, raw (YUV4MPEG2).
std::string raw_video(int first, int frames) {
  std::string text = "YUV4MPEG2 W64 H48 F10:1 Ip A1:1 C420jpeg\n";
  for (int i = first; i < first + frames; ++i) {
    cv::Mat luma;
    cv::extractChannel(numbered(i), luma, 0);
    text += "FRAME\n" + std::string(luma.ptr<char>(), luma.total());
    text.append(luma.total() / 2, '\x80');  // grey
  }
  return text;
}

/// Pipes that stand for a camera, each with a thread that writes into it once a program reads.
class PipeSource : public VideoSource {
 protected:
  ~PipeSource() override {
    std::vector<int> readers;  // for writers that wait
    for (const std::string& pipe : pipes_) {
      readers.push_back(open(pipe.c_str(), O_RDONLY | O_NONBLOCK));
    }
    for (std::thread& writer : writers_) writer.join();
    for (const int reader : readers) close(reader);
  }

  std::string new_pipe() {
    pipes_.push_back(folder_.path("pipe" + std::to_string(pipes_.size())));
    EXPECT_EQ(mkfifo(pipes_.back().c_str(), 0600), 0);
    return pipes_.back();
  }
  void write(const std::string& pipe, std::string video) {
    writers_.emplace_back([pipe, video = std::move(video)] {
      std::ofstream(pipe, std::ios::binary) << video;  // waits for a reader
    });
  }

 private:
  std::vector<std::string> pipes_;
  std::vector<std::thread> writers_;
};

TEST_F(PipeSource, ReadsWhatACameraSendsAndGoesOnWhenItComesBack) {
  const std::string first = new_pipe(), second = new_pipe(), camera = folder_.path("camera");
  std::filesystem::create_symlink(first, camera);
  write(first, raw_video(0, 5));
  write(second, raw_video(20, 5));
  PluginUnderTest source("sources/video", params("address: '" + camera + "', timeout_s: 20"));
  const PluginAnswer opened = source.process(kOpen, {});
  ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
  EXPECT_EQ(source.process(kCount, {}).get<weft::Count>()->live, 1);
  std::filesystem::remove(camera);
  std::filesystem::create_symlink(second, camera);
  std::vector<int> found;
  double last_s = -1.0;
  for (std::uint64_t i = 0; i < 10; ++i) {
    const PluginAnswer frame = source.process(kRead, {}, i);
    ASSERT_EQ(frame.status, i == 5 ? WEFT_DEGENERATE : WEFT_OK) << i << ": " << frame.message;
    if (i == 5) {
      EXPECT_THAT(frame.message, HasSubstr("the camera gave no frames for"));
    }
    found.push_back(number_in(*frame.get<weft::Image>()));
    const double time_s = frame.get<weft::Time>()->t_s;
    EXPECT_GT(time_s, last_s) << i;
    last_s = time_s;
  }
  EXPECT_THAT(found, ElementsAre(0, 1, 2, 3, 4, 20, 21, 22, 23, 24));
}

TEST_F(PipeSource, ACameraThatDoesNotComeBackIsAnErrorAndThenTheEnd) {
  const std::string pipe = new_pipe();
  write(pipe, raw_video(0, 5));
  PluginUnderTest source("sources/video", params("address: '" + pipe + "', timeout_s: 0.3"));
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  for (std::uint64_t i = 0; i < 5; ++i) ASSERT_EQ(source.process(kRead, {}, i).status, WEFT_OK);
  const PluginAnswer gone = source.process(kRead, {}, 5);
  EXPECT_EQ(gone.status, WEFT_ERROR);
  EXPECT_THAT(gone.message, HasSubstr("is it still connected?"));
  EXPECT_EQ(source.process(kRead, {}, 6).status, WEFT_END);
}

TEST_F(PipeSource, APipeWithoutAWriterIsRefused) {
  EXPECT_THAT(refusal("address: '" + new_pipe() + "', timeout_s: 0.05"),
              AllOf(HasSubstr("pipe0"), HasSubstr("no data was written")));
}

TEST_F(PipeSource, OneOfFileDeviceAndAddressIsGiven) {
  EXPECT_THAT(refusal("device: 0, address: '" + new_pipe() + "'"), HasSubstr("give one of"));
  EXPECT_THAT(refusal("address: nowhere.mp4"), HasSubstr("give a file as 'path'"));
}

}  // namespace
