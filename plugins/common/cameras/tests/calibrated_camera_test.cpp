// SPDX-License-Identifier: Apache-2.0
#include "common/cameras/calibrated_camera.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/cameras/tests/frame_folder.hpp"

namespace weft::cameras {
namespace {

using testing::FrameFolder;
using ::testing::HasSubstr;

// The pattern, smooth enough to be compared after resampling, at a position of the ideal image.
double brightness(double u, double v) {
  return 128.0 + 50.0 * std::sin(u / 9.0) + 50.0 * std::cos(v / 7.0 + u / 31.0);
}

struct Ray {
  double x, y;
};
using Lens = std::function<Ray(Ray)>;

/// The view of a camera with this lens, by inversion of the lens with fixed-point steps.
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
  const auto camera = CalibratedCamera::read(folder.path("camera.yaml"));
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->pinhole().fx, fx);
  EXPECT_EQ(camera->pinhole().cy, cy);
  const auto image = camera->undistorted(seen, "seen.png", "seen");
  ASSERT_TRUE(image) << image.error().message;
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

TEST(CalibratedCamera, UndoesTheBrownModelWithFiveCoefficients) {
  const double k1 = -0.22, k2 = 0.08, p1 = 0.003, p2 = -0.004, k3 = -0.01;
  expect_undistorted("[-0.22, 0.08, 0.003, -0.004, -0.01]", [&](Ray ray) {
    const double r2 = ray.x * ray.x + ray.y * ray.y, radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    return Ray{ray.x * radial + 2 * p1 * ray.x * ray.y + p2 * (r2 + 2 * ray.x * ray.x),
               ray.y * radial + p1 * (r2 + 2 * ray.y * ray.y) + 2 * p2 * ray.x * ray.y};
  });
}

TEST(CalibratedCamera, UndoesTheBrownModelWithEightCoefficients) {
  expect_undistorted("[0.1, 0.05, 0.001, 0.002, 0.01, 0.3, 0.02, 0.005]", [](Ray ray) {
    const double r2 = ray.x * ray.x + ray.y * ray.y;
    const double radial =
        (1 + r2 * (0.1 + r2 * (0.05 + r2 * 0.01))) / (1 + r2 * (0.3 + r2 * (0.02 + r2 * 0.005)));
    return Ray{ray.x * radial + 2 * 0.001 * ray.x * ray.y + 0.002 * (r2 + 2 * ray.x * ray.x),
               ray.y * radial + 0.001 * (r2 + 2 * ray.y * ray.y) + 2 * 0.002 * ray.x * ray.y};
  });
}

TEST(CalibratedCamera, UndoesTheFisheyeModel) {
  expect_undistorted("{model: fisheye, coefficients: [-0.05, 0.01, 0.002, -0.001]}", [](Ray ray) {
    const double r = std::hypot(ray.x, ray.y), t = std::atan(r), t2 = t * t;
    if (r < 1e-12) return ray;
    const double bent = t * (1 + t2 * (-0.05 + t2 * (0.01 + t2 * (0.002 - t2 * 0.001))));
    return Ray{ray.x / r * bent, ray.y / r * bent};
  });
}

TEST(CalibratedCamera, UndoesAFisheyeWhoseCoefficientsAreZero) {
  expect_undistorted("{model: fisheye, coefficients: [0, 0, 0, 0]}", [](Ray ray) {
    const double r = std::hypot(ray.x, ray.y);
    if (r < 1e-12) return ray;
    return Ray{ray.x / r * std::atan(r), ray.y / r * std::atan(r)};
  });
}

TEST(CalibratedCamera, TakesEachDepthFromTheNearestPixel) {
  constexpr int kWidth = 160, kHeight = 120;
  constexpr double kF = 150.0, kCx = 81.0, kCy = 58.0, kK1 = -0.22;
  const FrameFolder folder;
  folder.write("camera.yaml",
               "{fx: 150, fy: 150, cx: 81, cy: 58, width: 160, height: 120, "
               "distortion: [-0.22, 0, 0, 0, 0]}");
  const auto camera = CalibratedCamera::read(folder.path("camera.yaml"));
  ASSERT_TRUE(camera) << camera.error().message;
  cv::Mat stored(kHeight, kWidth, CV_16UC1);  // each pixel has a different value, and none is 0
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      stored.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(1 + u + kWidth * v);
    }
  }
  const auto depth_m = camera->undistorted_depth(stored, "d.png", 1.0);
  ASSERT_TRUE(depth_m) << depth_m.error().message;
  double worst_px = 0.0, shift_px = 0.0;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const double x = (u - kCx) / kF, y = (v - kCy) / kF, radial = 1 + kK1 * (x * x + y * y);
      const int value = static_cast<int>((*depth_m)(v, u)) - 1;
      ASSERT_GE(value, 0) << "the lens sees all of the ideal image";
      const double du = value % kWidth - (kF * x * radial + kCx);
      const double dv = value / kWidth - (kF * y * radial + kCy);
      worst_px = std::max({worst_px, std::abs(du), std::abs(dv)});
      shift_px = std::max(shift_px, std::abs(kF * x * (radial - 1.0)));
    }
  }
  EXPECT_LT(worst_px, 0.5 + 1.0 / 32);
  EXPECT_GT(shift_px, 3.0) << "the lens is too weak for this test";
}

TEST(CalibratedCamera, KeepsThePixelsOfAnIdealCameraAndRefusesOtherSizes) {
  const FrameFolder folder;
  folder.write_camera();
  const auto camera = CalibratedCamera::read(folder.path("camera.yaml"));
  ASSERT_TRUE(camera) << camera.error().message;
  const auto image = camera->undistorted(cv::Mat(6, 8, CV_8UC3, cv::Scalar(1, 2, 3)), "a", "stem");
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->stem, "stem");
  EXPECT_EQ(image->pixels(5, 23), 3);
  const auto other = camera->undistorted(cv::Mat(5, 7, CV_8UC1), "seen.png", "");
  ASSERT_FALSE(other);
  for (const char* part : {"seen.png", "7 x 5", "8 x 6", "camera.yaml"}) {
    EXPECT_THAT(other.error().message, HasSubstr(part));
  }
}

}  // namespace
}  // namespace weft::cameras
