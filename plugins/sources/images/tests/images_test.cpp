// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/image.hpp>

#include "frame_folder.hpp"

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using weft::testing::FrameFolder;
using weft::testing::images_source;
using weft::testing::kCount;
using weft::testing::kOpen;
using weft::testing::kRead;
using weft::testing::Outcome;
using weft::testing::PluginUnderTest;

std::int64_t opened_count(PluginUnderTest& source) {
  const Outcome opened = source.process(kOpen, {});
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
  const Outcome opened = source.process(kOpen, {});
  EXPECT_EQ(opened.status, WEFT_ERROR);
  return opened.message;
}

TEST(ImagesSource, GivesFramesInBytewiseOrderWithTheirTime) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write_frame("frames/b10.png", 3);
  folder.write_frame("frames/b9.png", 4);
  folder.write_frame("frames/B11.png", 1);
  folder.write_frame("frames/a.png", 2);
  folder.write_frame("frames/.hidden.png", 9);
  folder.write("frames/notes.txt", "no image");
  PluginUnderTest source = images_source(folder, "frames/*.png", "fps: 25");
  ASSERT_EQ(opened_count(source), 4);
  const std::vector<std::string> stems{"B11", "a", "b10", "b9"};
  for (std::uint64_t i = 0; i < 4; ++i) {
    const Outcome frame = source.process(kRead, {}, i);
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
    const Outcome frame = source.process(kRead, {}, i);
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
  const Outcome frame = source.process(kRead, {}, 1);
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

// The pattern, smooth enough to be compared after resampling, at a position of the ideal image.
double brightness(double u, double v) {
  return 128.0 + 50.0 * std::sin(u / 9.0) + 50.0 * std::cos(v / 7.0 + u / 31.0);
}

struct Ray {
  double x, y;
};
using Lens = std::function<Ray(Ray)>;

/// What a camera with this lens would see, found by inverting the lens with fixed-point steps.
cv::Mat distorted_image(cv::Size size, double fx, double fy, double cx, double cy,
                        const Lens& lens) {
  cv::Mat image(size, CV_8UC1);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const Ray seen{(u - cx) / fx, (v - cy) / fy};
      Ray ideal = seen;
      for (int step = 0; step < 60; ++step) {
        const Ray again = lens(ideal);
        ideal = {ideal.x + seen.x - again.x, ideal.y + seen.y - again.y};
      }
      const Ray check = lens(ideal);
      EXPECT_NEAR(check.x, seen.x, 1e-9);
      EXPECT_NEAR(check.y, seen.y, 1e-9);
      image.at<std::uint8_t>(v, u) =
          static_cast<std::uint8_t>(std::lround(brightness(fx * ideal.x + cx, fy * ideal.y + cy)));
    }
  }
  return image;
}

void expect_undistorted(const std::string& distortion, const Lens& lens) {
  const cv::Size size(160, 120);
  const double fx = 150.0, fy = 155.0, cx = 81.0, cy = 58.0;
  const FrameFolder folder;
  folder.write("camera.yaml",
               "{fx: 150, fy: 155, cx: 81, cy: 58, width: 160, height: 120, "
               "distortion: " +
                   distortion + "}");
  const cv::Mat seen = distorted_image(size, fx, fy, cx, cy, lens);
  folder.write_image("frames/0.png", seen);
  PluginUnderTest source = images_source(folder);
  const auto camera = source.process(kOpen, {}).get<weft::Camera>();
  ASSERT_TRUE(camera.has_value());
  EXPECT_EQ(camera->fx, fx);
  EXPECT_EQ(camera->cy, cy);
  const auto image = source.process(kRead, {}).get<weft::Image>();
  ASSERT_TRUE(image.has_value());
  double worst = 0.0, worst_before = 0.0;
  for (int v = 20; v < size.height - 20; ++v) {
    for (int u = 20; u < size.width - 20; ++u) {
      worst = std::max(worst, std::abs(image->pixels(v, u) - brightness(u, v)));
      worst_before =
          std::max(worst_before, std::abs(seen.at<std::uint8_t>(v, u) - brightness(u, v)));
    }
  }
  EXPECT_LT(worst, 2.0);
  EXPECT_GT(worst_before, 5.0) << "the lens is too weak for this test";
}

TEST(ImagesSource, UndoesTheBrownModelWithFiveCoefficients) {
  const double k1 = -0.22, k2 = 0.08, p1 = 0.003, p2 = -0.004, k3 = -0.01;
  expect_undistorted("[-0.22, 0.08, 0.003, -0.004, -0.01]", [&](Ray ray) {
    const double r2 = ray.x * ray.x + ray.y * ray.y, radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    return Ray{ray.x * radial + 2 * p1 * ray.x * ray.y + p2 * (r2 + 2 * ray.x * ray.x),
               ray.y * radial + p1 * (r2 + 2 * ray.y * ray.y) + 2 * p2 * ray.x * ray.y};
  });
}

TEST(ImagesSource, UndoesTheBrownModelWithEightCoefficients) {
  expect_undistorted("[0.1, 0.05, 0.001, 0.002, 0.01, 0.3, 0.02, 0.005]", [](Ray ray) {
    const double r2 = ray.x * ray.x + ray.y * ray.y;
    const double radial =
        (1 + r2 * (0.1 + r2 * (0.05 + r2 * 0.01))) / (1 + r2 * (0.3 + r2 * (0.02 + r2 * 0.005)));
    return Ray{ray.x * radial + 2 * 0.001 * ray.x * ray.y + 0.002 * (r2 + 2 * ray.x * ray.x),
               ray.y * radial + 0.001 * (r2 + 2 * ray.y * ray.y) + 2 * 0.002 * ray.x * ray.y};
  });
}

TEST(ImagesSource, UndoesTheFisheyeModel) {
  expect_undistorted("{model: fisheye, coefficients: [-0.05, 0.01, 0.002, -0.001]}", [](Ray ray) {
    const double r = std::hypot(ray.x, ray.y), t = std::atan(r), t2 = t * t;
    if (r < 1e-12) return ray;
    const double bent = t * (1 + t2 * (-0.05 + t2 * (0.01 + t2 * (0.002 - t2 * 0.001))));
    return Ray{ray.x / r * bent, ray.y / r * bent};
  });
}

TEST(ImagesSource, ReadsTheKinectPaperSequence) {
  const char* data = std::getenv("WEFT_DATA");
  if (data == nullptr) GTEST_SKIP() << "WEFT_DATA is not set";
  const std::string folder = std::string(data) + "/kinect_paper";
  PluginUnderTest source("sources/images", "{path: '" + folder + "/frames/*.png', camera: '" +
                                               folder + "/K.json', truth: '" + folder +
                                               "/gt/*.csv', apart: {\"009\": texture source}}");
  ASSERT_EQ(opened_count(source), 100);
  int with_truth = 0, apart = 0;
  for (std::uint64_t i = 0; i < 100; ++i) {
    const Outcome frame = source.process(kRead, {}, i);
    ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
    const auto truth = frame.get<weft::GroundTruth>();
    if (!truth) continue;
    ++with_truth;
    EXPECT_EQ(truth->count(), truth->kind == "mdh301" ? 301 : 90);
    if (!truth->apart.empty()) {
      ++apart;
      EXPECT_EQ(frame.get<weft::Image>()->stem, "009");
    }
  }
  EXPECT_EQ(with_truth, 17);
  EXPECT_EQ(apart, 1);
}

}  // namespace
