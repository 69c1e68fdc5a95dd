// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <stdlib.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>
#include <weft/data/correspondences.hpp>
#include <weft/data/image.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/visibility.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using weft::Image;
using weft::Shape;
using weft::ShapeState;
using weft::testing::input;
using weft::testing::Input;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr int kOpen = 0, kWrite = 1, kFinish = 2;
constexpr int kWidth = 160, kHeight = 120;
constexpr std::uint8_t kGrey = 100;

int frames_in(const fs::path& video) {
  cv::VideoCapture capture(video.string(), cv::CAP_FFMPEG);
  int count = 0;
  for (cv::Mat frame; capture.isOpened() && capture.read(frame);) ++count;
  return count;
}

class OverlaySink : public ::testing::Test {
 protected:
  OverlaySink() {
    std::string pattern = (fs::temp_directory_path() / "weft_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
    camera_.fx = camera_.fy = 100.0;
    camera_.cx = 80.0;
    camera_.cy = 60.0;
    camera_.width_px = kWidth;
    camera_.height_px = kHeight;
    image_.stem = "009";
    image_.pixels = weft::Array<std::uint8_t>({kHeight, kWidth, 3}, 0);
    std::fill_n(image_.pixels.data(), image_.pixels.size(), kGrey);
    // A square of 40 x 40 px around the principal point, 1 m before the camera.
    shape_.vertices_m = weft::Array<double>({4, 3}, 0.0);
    for (std::int64_t v = 0; v < 4; ++v) {
      shape_.vertices_m(v, 0) = v % 2 == 0 ? -0.2 : 0.2;
      shape_.vertices_m(v, 1) = v < 2 ? -0.2 : 0.2;
      shape_.vertices_m(v, 2) = 1.0;
    }
    shape_.source = weft::Array<std::uint8_t>({4}, 0);
  }
  ~OverlaySink() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  PluginUnderTest sink(const std::string& more = "", const std::string& name = "view.avi") const {
    return PluginUnderTest("sinks/overlay",
                           "{path: '" + (folder_ / name).string() + "'" + more + "}");
  }

  PluginAnswer open(PluginUnderTest& plugin) const {
    const auto prepared = plugin.prepare(templ_, camera_);
    EXPECT_TRUE(prepared) << prepared.error().message;
    return plugin.process(kOpen, {});
  }

  std::vector<Input> inputs(bool with_shape = true) const {
    std::vector<Input> list{input("image", image_), input("camera", camera_),
                            input("template", templ_)};
    if (with_shape) list.push_back(input("shape", shape_));
    return list;
  }

  /// The still of one frame with these inputs, without the losses of the video.
  cv::Mat still(const std::vector<Input>& list, const std::string& more = "") const {
    PluginUnderTest plugin("sinks/overlay", "{path: '" + (folder_ / "s.avi").string() +
                                                "', stills_every: 1" + more + "}");
    EXPECT_EQ(open(plugin).status, WEFT_OK);
    const PluginAnswer written = plugin.process(kWrite, list, 3);
    EXPECT_EQ(written.status, WEFT_OK) << written.message;
    EXPECT_EQ(plugin.process(kFinish, {}).status, WEFT_OK);
    return cv::imread((folder_ / "s" / "000003.png").string());
  }

  fs::path folder_;
  weft::Camera camera_;
  weft::Template templ_ = weft::testing::make_template({2, 2, 0.4, 0.4, 16, 16});
  Image image_;
  Shape shape_;
};

TEST_F(OverlaySink, WritesEveryFrameIntoTheVideo) {
  for (const char* name : {"view.avi", "view.mkv", "view.mp4"}) {
    auto plugin = sink(", fps: 10", name);
    ASSERT_EQ(open(plugin).status, WEFT_OK);
    for (std::uint64_t i = 0; i < 12; ++i) {
      ASSERT_EQ(plugin.process(kWrite, inputs(i % 3 != 0), i).status, WEFT_OK);
    }
    ASSERT_EQ(plugin.process(kFinish, {}).status, WEFT_OK);
    EXPECT_EQ(frames_in(folder_ / name), 12) << name;
    cv::VideoCapture capture((folder_ / name).string(), cv::CAP_FFMPEG);
    EXPECT_NEAR(capture.get(cv::CAP_PROP_FPS), 10.0, 1e-6);
  }
}

TEST_F(OverlaySink, LeavesAllButThreeFramesInTheVideoWhenTheRunIsKilled) {
  for (const std::string name : {"view.avi", "view.mkv", "view.mp4"}) {
    auto plugin = sink("", name);
    ASSERT_EQ(open(plugin).status, WEFT_OK);
    for (int i = 0; i < 12; ++i) {
      ASSERT_EQ(plugin.process(kWrite, inputs(), static_cast<std::uint64_t>(i)).status, WEFT_OK);
      // The file on the disk now is the one that a killed process leaves behind.
      fs::copy_file(folder_ / name, folder_ / ("killed_" + name),
                    fs::copy_options::overwrite_existing);
      EXPECT_GE(frames_in(folder_ / ("killed_" + name)), i + 1 - 3) << name;
    }
  }
}

TEST_F(OverlaySink, KeepsTheOrderOfTheFrames) {
  auto plugin = sink(", view: image");
  ASSERT_EQ(open(plugin).status, WEFT_OK);
  for (int i = 0; i < 25; ++i) {
    std::fill_n(image_.pixels.data(), image_.pixels.size(), static_cast<std::uint8_t>(10 * i));
    ASSERT_EQ(plugin.process(kWrite, inputs(false), static_cast<std::uint64_t>(i)).status, WEFT_OK);
  }
  ASSERT_EQ(plugin.process(kFinish, {}).status, WEFT_OK);
  cv::VideoCapture capture((folder_ / "view.avi").string(), cv::CAP_FFMPEG);
  for (int i = 0; i < 25; ++i) {
    cv::Mat frame;
    ASSERT_TRUE(capture.read(frame)) << i;
    EXPECT_NEAR(frame.at<cv::Vec3b>(20, 20)[1], 10 * i, 4) << i;
  }
}

TEST_F(OverlaySink, NamesTheFrameOfAFailureAndGoesOn) {
  auto plugin = sink(", stills_every: 2");
  ASSERT_EQ(open(plugin).status, WEFT_OK);
  std::ofstream(folder_ / "view") << "a file where the folder of the stills is needed";
  int failed = 0;
  const auto count = [&](const PluginAnswer& answer) {
    if (answer.status == WEFT_OK) return;
    EXPECT_THAT(answer.message, HasSubstr("frame " + std::to_string(2 * failed) + ": "));
    ++failed;
  };
  for (std::uint64_t i = 0; i < 8; ++i) count(plugin.process(kWrite, inputs(), i));
  count(plugin.process(kFinish, {}));
  EXPECT_GE(failed, 3);
  EXPECT_EQ(frames_in(folder_ / "view.avi"), 8);
}

TEST_F(OverlaySink, KeepsOddSizesInEveryFormat) {
  camera_.width_px = 161;
  camera_.height_px = 121;
  image_.pixels = weft::Array<std::uint8_t>({121, 161, 3}, 0);
  const cv::Mat picture = still(inputs(), ", view: image");
  for (const std::string name : {"view.avi", "view.mkv", "view.mp4"}) {
    auto plugin = sink(", view: image", name);
    ASSERT_EQ(open(plugin).status, WEFT_OK);
    ASSERT_EQ(plugin.process(kWrite, inputs(), 0).status, WEFT_OK);
    ASSERT_EQ(plugin.process(kFinish, {}).status, WEFT_OK);
    cv::VideoCapture capture((folder_ / name).string(), cv::CAP_FFMPEG);
    cv::Mat frame;
    ASSERT_TRUE(capture.read(frame)) << name;
    const int more = name.ends_with("mp4") ? 1 : 0;  // H.264 with a colour for 2 x 2 px is even
    EXPECT_EQ(frame.cols, 161 + more) << name;
    EXPECT_EQ(frame.rows, picture.rows + more * (picture.rows % 2)) << name;
    const cv::Rect inner(0, 0, 160, 120);
    EXPECT_LT(cv::norm(frame(inner), picture(inner), cv::NORM_L1) / inner.area() / 3, 3.0) << name;
  }
}

TEST_F(OverlaySink, FailsToFinishAVideoThatLacksFrames) {
  for (int i = 0; i < image_.pixels.size(); ++i) {
    image_.pixels.data()[i] =
        static_cast<std::uint8_t>(static_cast<unsigned>(i) * 2654435761U >> 24U);
  }
  auto plugin = sink("", "view.mkv");
  ASSERT_EQ(open(plugin).status, WEFT_OK);
  for (std::uint64_t i = 0; i < 200; ++i) {
    ASSERT_EQ(plugin.process(kWrite, inputs(), i).status, WEFT_OK);
  }
  ASSERT_GT(fs::file_size(folder_ / "view.mkv"), 10'000U);
  fs::remove(folder_ / "view.mkv");  // as if nothing of it had reached the disk
  const PluginAnswer finished = plugin.process(kFinish, {});
  EXPECT_EQ(finished.status, WEFT_ERROR);
  EXPECT_THAT(finished.message, HasSubstr("view.mkv has 0 of 200 frames"));
}

TEST_F(OverlaySink, DrawsEdgesWhereTheCameraSeesThem) {
  const cv::Mat picture = still(inputs());
  // The border of the square: x from 60 to 100, y from 40 to 80.
  for (int along = 45; along <= 75; along += 5) {
    for (const cv::Point& p : {cv::Point(60, along), cv::Point(100, along),
                               cv::Point(along + 20, 40), cv::Point(along + 20, 80)}) {
      const cv::Vec3b colour = picture.at<cv::Vec3b>(p);
      EXPECT_GT(colour[0], colour[2] + 60) << p;
      EXPECT_GT(colour[0], colour[1] + 30) << p;
    }
  }
  EXPECT_EQ(picture.at<cv::Vec3b>(20, 20), cv::Vec3b(kGrey, kGrey, kGrey));
  for (int x = 64; x <= 96; x += 4) {
    EXPECT_EQ(picture.at<cv::Vec3b>(60, x), cv::Vec3b(kGrey, kGrey, kGrey)) << "inside, " << x;
  }
}

TEST_F(OverlaySink, DrawsBetweenPixels) {
  // The centre of brightness across a thin line follows a shift of a quarter pixel.
  const auto centre_of_left_edge = [&] {
    const cv::Mat picture = still(inputs());
    double sum = 0.0, moment = 0.0;
    for (int x = 54; x <= 66; ++x) {
      const double weight = std::abs(picture.at<cv::Vec3b>(70, x)[1] - 100.0);
      sum += weight;
      moment += weight * x;
    }
    return moment / sum;
  };
  const double before = centre_of_left_edge();
  for (std::int64_t v = 0; v < 4; ++v) shape_.vertices_m(v, 0) += 0.0025;
  EXPECT_NEAR(centre_of_left_edge() - before, 0.25, 0.15);
}

TEST_F(OverlaySink, ColoursTheMeshByTheConfidence) {
  const auto colour_of = [&](double confidence) {
    shape_.confidence = confidence;
    return still(inputs()).at<cv::Vec3b>(40, 75);
  };
  const cv::Vec3b none = colour_of(0.0), half = colour_of(0.5), full = colour_of(1.0);
  EXPECT_TRUE(none[2] > none[1] + 60 && none[2] > none[0] + 60) << "orange";
  EXPECT_TRUE(half[2] > half[0] + 60 && half[1] > half[0] + 60) << "yellow";
  EXPECT_TRUE(full[0] > full[1] + 30 && full[0] > full[2] + 60) << "blue";
}

TEST_F(OverlaySink, DrawsAShapeThatWasNotMeasuredFainter) {
  shape_.confidence = 0.0;
  const auto strength_of = [&](ShapeState state) {
    shape_.state = static_cast<std::int32_t>(state);
    return still(inputs()).at<cv::Vec3b>(40, 75)[2] - kGrey;
  };
  const int weak = strength_of(ShapeState::weak), predicted = strength_of(ShapeState::predicted);
  EXPECT_EQ(strength_of(ShapeState::estimated), weak);
  EXPECT_GT(weak, predicted + 10);
  EXPECT_GT(predicted, strength_of(ShapeState::lost) + 10);
}

TEST_F(OverlaySink, AllPicturesHaveOneSizeWhateverTheyShow) {
  // Beside the image a square, or a panel of its width if it is upright; below a strip.
  const cv::Mat whole = still(inputs());
  EXPECT_EQ(whole.cols, kWidth + kHeight);
  EXPECT_GT(whole.rows, kHeight);
  EXPECT_EQ(still(inputs(false)).size(), whole.size());
  EXPECT_EQ(still(inputs(), ", view: image").size(), cv::Size(kWidth, whole.rows));
  std::swap(camera_.width_px, camera_.height_px);
  image_.pixels = weft::Array<std::uint8_t>({kWidth, kHeight}, 0);
  const cv::Mat upright = still(inputs());
  EXPECT_EQ(upright.cols, 2 * kHeight);
  EXPECT_EQ(upright.rows - kWidth, whole.rows - kHeight);
}

TEST_F(OverlaySink, SwingsAroundTheMeshByTheNumberOfTheFrameAlone) {
  PluginUnderTest plugin("sinks/overlay", "{path: '" + (folder_ / "s.avi").string() +
                                              "', stills_every: 1, turn_frames: 40}");
  ASSERT_EQ(open(plugin).status, WEFT_OK);
  for (const std::uint64_t frame : {3U, 13U, 43U}) {
    EXPECT_EQ(plugin.process(kWrite, inputs(), frame).status, WEFT_OK);
  }
  ASSERT_EQ(plugin.process(kFinish, {}).status, WEFT_OK);
  const auto panel_of = [&](std::uint64_t frame) {
    char name[16];
    std::snprintf(name, sizeof name, "%06d.png", static_cast<int>(frame));
    const cv::Mat picture = cv::imread((folder_ / "s" / name).string());
    return cv::Mat(picture, cv::Range(0, kHeight), cv::Range(kWidth, picture.cols)).clone();
  };
  const cv::Mat first = panel_of(3), later = panel_of(13), again = panel_of(43);
  EXPECT_GT(cv::norm(first, later, cv::NORM_L1), 1000.0);
  EXPECT_EQ(cv::norm(first, again, cv::NORM_L1), 0.0);
}

TEST_F(OverlaySink, FadesWhatWasNotMeasuredInTheViewFromTheSide) {
  std::fill_n(templ_.texture.data(), templ_.texture.size(), std::uint8_t{40});
  const auto darkness = [&] {
    const cv::Mat picture = still(inputs());
    return 255.0 - cv::mean(picture(cv::Rect(kWidth + 40, 40, 40, 30)))[0];
  };
  std::fill_n(shape_.source.data(), 4, std::uint8_t{1});
  const double measured = darkness();
  std::fill_n(shape_.source.data(), 4, std::uint8_t{0});
  EXPECT_LT(darkness(), 0.75 * measured);
}

TEST_F(OverlaySink, DashesEdgesThatTheCameraDoesNotSee) {
  weft::Visibility sight;
  sight.visible = weft::Array<std::uint8_t>({4}, 0);
  sight.reason = weft::Array<std::uint8_t>({4}, 0);
  sight.score = weft::Array<double>({4}, 0.0);
  sight.visible(0) = sight.visible(1) = 1;  // the upper border, y = 40
  auto list = inputs();
  list.push_back(input("visibility", sight));
  const cv::Mat picture = still(list), without = still(inputs());
  // How much of a border from x = 62 to 98 is left as it was.
  const auto untouched = [](const cv::Mat& canvas, int y) {
    int count = 0;
    for (int x = 62; x <= 98; ++x) {
      count += canvas.at<cv::Vec3b>(y, x) == cv::Vec3b(kGrey, kGrey, kGrey) ? 1 : 0;
    }
    return count;
  };
  EXPECT_EQ(untouched(picture, 40), 0);
  EXPECT_EQ(untouched(without, 80), 0);
  EXPECT_GT(untouched(picture, 80), 3);
  EXPECT_LT(untouched(picture, 80), 28);
}

TEST_F(OverlaySink, WithoutAShapeTheImageStaysAsItIs) {
  const cv::Mat picture = still(inputs(false));
  const cv::Mat image(kHeight, kWidth, CV_8UC3, cv::Scalar::all(kGrey));
  EXPECT_EQ(cv::norm(picture(cv::Rect(0, 0, kWidth, kHeight)), image, cv::NORM_L1), 0.0);
  // Words below it and beside it.
  for (const cv::Rect& place : {cv::Rect(0, kHeight, kWidth, picture.rows - kHeight),
                                cv::Rect(kWidth, kHeight / 3, kHeight, kHeight / 4)}) {
    double darkest = 0.0;
    cv::minMaxLoc(picture(place).clone().reshape(1), &darkest, nullptr);
    EXPECT_LT(darkest, 220.0);
  }
}

TEST_F(OverlaySink, DrawsKeptMatchesOnly) {
  weft::Correspondences matches;
  matches.template_px = weft::Array<double>({2, 2}, 0.0);
  matches.image_px = weft::Array<double>({2, 2}, 0.0);
  matches.face = weft::Array<std::int32_t>({2}, 0);
  matches.barycentrics = weft::Array<double>({2, 3}, 0.0);
  matches.kept = weft::Array<std::uint8_t>({2}, 0);
  matches.score = weft::Array<double>({2}, 0.0);
  matches.kept(0) = 1;
  for (std::int64_t i = 0; i < 2; ++i) {
    matches.image_px(i, 0) = i == 0 ? 20.0 : 140.0;
    matches.image_px(i, 1) = 30.0;
  }
  auto list = inputs();
  list.push_back(input("correspondences", matches));
  const cv::Vec3b background(kGrey, kGrey, kGrey);
  EXPECT_NE(still(list, ", draw_matches: true").at<cv::Vec3b>(30, 20), background);
  EXPECT_EQ(still(list, ", draw_matches: true").at<cv::Vec3b>(30, 140), background);
  EXPECT_EQ(still(list).at<cv::Vec3b>(30, 20), background);
}

TEST_F(OverlaySink, SurvivesVerticesThatCannotBeSeen) {
  shape_.vertices_m(0, 2) = -1.0;   // behind the camera
  shape_.vertices_m(1, 2) = 1e-12;  // projects far away
  shape_.vertices_m(2, 0) = std::nan("");
  const cv::Mat picture = still(inputs());
  EXPECT_EQ(picture.at<cv::Vec3b>(20, 20), cv::Vec3b(kGrey, kGrey, kGrey));
}

TEST_F(OverlaySink, AcceptsGreyFrames) {
  image_.pixels = weft::Array<std::uint8_t>({kHeight, kWidth}, 0);
  std::fill_n(image_.pixels.data(), image_.pixels.size(), kGrey);
  EXPECT_EQ(still(inputs()).at<cv::Vec3b>(20, 20), cv::Vec3b(kGrey, kGrey, kGrey));
}

TEST_F(OverlaySink, AFrameOfAnotherSizeIsAnErrorOfThatFrame) {
  auto plugin = sink();
  ASSERT_EQ(open(plugin).status, WEFT_OK);
  Image small;
  small.stem = "small";
  small.pixels = weft::Array<std::uint8_t>({10, 20}, 0);
  auto list = inputs();
  list[0] = input("image", small);
  const PluginAnswer refused = plugin.process(kWrite, list, 0);
  EXPECT_EQ(refused.status, WEFT_ERROR);
  EXPECT_THAT(refused.message, HasSubstr("20 x 10"));
  EXPECT_EQ(plugin.process(kWrite, inputs(), 1).status, WEFT_OK);
  ASSERT_EQ(plugin.process(kFinish, {}).status, WEFT_OK);
  EXPECT_EQ(frames_in(folder_ / "view.avi"), 1);
}

TEST_F(OverlaySink, KeepsEveryNthFrameAsAStill) {
  auto plugin = sink(", stills_every: 4");
  ASSERT_EQ(open(plugin).status, WEFT_OK);
  for (std::uint64_t i = 0; i < 9; ++i) {
    ASSERT_EQ(plugin.process(kWrite, inputs(), i).status, WEFT_OK);
  }
  ASSERT_EQ(plugin.process(kFinish, {}).status, WEFT_OK);
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_ / "view")) {
    names.push_back(entry.path().filename().string());
  }
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("000000.png", "000004.png", "000008.png"));
}

TEST_F(OverlaySink, PutsStillsIntoAFolderOfChoice) {
  auto plugin = sink(", stills_every: 1, stills: '" + (folder_ / "chosen").string() + "'");
  ASSERT_EQ(open(plugin).status, WEFT_OK);
  ASSERT_EQ(plugin.process(kWrite, inputs(), 0).status, WEFT_OK);
  ASSERT_EQ(plugin.process(kFinish, {}).status, WEFT_OK);
  EXPECT_TRUE(fs::exists(folder_ / "chosen" / "000000.png"));
  EXPECT_FALSE(fs::exists(folder_ / "view"));
}

TEST_F(OverlaySink, KeepsStillsAsJpegWhenAskedTo) {
  auto plugin = sink(", stills_every: 1, stills_format: jpg");
  ASSERT_EQ(open(plugin).status, WEFT_OK);
  ASSERT_EQ(plugin.process(kWrite, inputs(), 0).status, WEFT_OK);
  ASSERT_EQ(plugin.process(kFinish, {}).status, WEFT_OK);
  EXPECT_FALSE(fs::exists(folder_ / "view" / "000000.png"));
  EXPECT_EQ(cv::imread((folder_ / "view" / "000000.jpg").string()).size(), still(inputs()).size());
}

TEST_F(OverlaySink, MakesStillsSmallerButNeverLarger) {
  const cv::Mat whole = still(inputs());
  const cv::Mat half = still(inputs(), ", stills_width_px: " + std::to_string(whole.cols / 2));
  EXPECT_EQ(half.cols, whole.cols / 2);
  EXPECT_EQ(half.rows, whole.rows / 2);
  EXPECT_EQ(still(inputs(), ", stills_width_px: 10000").size(), whole.size());
}

TEST_F(OverlaySink, RefusesFormatsThatAKilledRunWouldLeaveBroken) {
  auto plugin = sink("", "view.mov");
  const PluginAnswer refused = open(plugin);
  EXPECT_EQ(refused.status, WEFT_ERROR);
  EXPECT_THAT(refused.message, ::testing::AllOf(HasSubstr("view.mov"), HasSubstr(".avi")));
}

TEST_F(OverlaySink, NamesTheVideoThatCannotBeWritten) {
  std::ofstream(folder_ / "file") << "a file where a folder is needed";
  auto plugin = sink("", "file/view.avi");
  const PluginAnswer refused = open(plugin);
  EXPECT_EQ(refused.status, WEFT_ERROR);
  EXPECT_THAT(refused.message, HasSubstr("file/view.avi"));
}

}  // namespace
