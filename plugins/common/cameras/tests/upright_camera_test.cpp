// SPDX-License-Identifier: Apache-2.0
#include "common/cameras/upright_camera.hpp"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>
#include <weft/images/orientation.hpp>

#include "common/images/decoder.hpp"

namespace weft::cameras {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

CameraFile sensor(Distortion model) {
  CameraFile file;
  file.camera.fx = 610.0, file.camera.fy = 600.0;
  file.camera.cx = 331.25, file.camera.cy = 222.5;
  file.camera.width_px = 640, file.camera.height_px = 480;
  file.model = model;
  if (model == Distortion::brown) {
    file.coefficients = {-0.11, 0.04, 0.003, -0.005, 0.01, 0.02, 0.01, -0.01};
  } else if (model == Distortion::fisheye) {
    file.coefficients = {0.05, -0.02, 0.01, -0.004};
  }
  return file;
}

/// Where each stored pixel is in the upright image, found by moving a mark with the pixels.
cv::Point moved(const cv::Size& size, const cv::Point& stored, int orientation) {
  cv::Mat mark = cv::Mat::zeros(size, CV_8U);
  mark.at<std::uint8_t>(stored) = 255;
  cv::Point found;
  cv::minMaxLoc(image_files::upright(mark, orientation), nullptr, nullptr, nullptr, &found);
  return found;
}

TEST(UprightCamera, SeesEachPointWhereTheUprightImageShowsIt) {
  for (const Distortion model : {Distortion::none, Distortion::brown, Distortion::fisheye}) {
    const CameraFile file = sensor(model);
    for (const int orientation : {1, 3, 6, 8}) {
      const auto upright = upright_camera(file, "camera.yaml", {{640, 480}, orientation}, "a.jpg");
      ASSERT_TRUE(upright) << upright.error().message;
      EXPECT_EQ(upright->is_rotated, orientation != 1);
      const Camera& a = file.camera;
      const Camera& b = upright->file.camera;
      const auto turned = [&](const Eigen::Vector2d& px) -> Eigen::Vector2d {
        if (orientation == 3) return {639.0 - px.x(), 479.0 - px.y()};
        if (orientation == 6) return {479.0 - px.y(), px.x()};
        if (orientation == 8) return {px.y(), 639.0 - px.x()};
        return px;
      };
      EXPECT_EQ(moved({640, 480}, {5, 9}, orientation),
                cv::Point(turned({5.0, 9.0}).x(), turned({5.0, 9.0}).y()));
      for (const double x : {-0.4, -0.1, 0.25}) {
        for (const double y : {-0.3, 0.05, 0.35}) {
          const Eigen::Vector2d ray(x, y);
          // The same ray in the frame of the upright image.
          const Eigen::Vector2d other = orientation == 3   ? Eigen::Vector2d(-x, -y)
                                        : orientation == 6 ? Eigen::Vector2d(-y, x)
                                        : orientation == 8 ? Eigen::Vector2d(y, -x)
                                                           : ray;
          const Eigen::Vector2d stored = seen_px(file, {a.fx * x + a.cx, a.fy * y + a.cy});
          const Eigen::Vector2d seen =
              seen_px(upright->file, {b.fx * other.x() + b.cx, b.fy * other.y() + b.cy});
          EXPECT_LT((seen - turned(stored)).norm(), 1e-9) << orientation;
        }
      }
    }
  }
}

TEST(UprightCamera, TakesACameraOfTheUprightSizeAsItIs) {
  const CameraFile file = sensor(Distortion::brown);
  const auto upright = upright_camera(file, "camera.yaml", {{480, 640}, 6}, "a.jpg");
  ASSERT_TRUE(upright);
  EXPECT_FALSE(upright->is_rotated);
  EXPECT_EQ(upright->file.camera.fx, file.camera.fx);
  EXPECT_EQ(upright->file.coefficients, file.coefficients);
}

TEST(UprightCamera, NamesBothSizesAndTheOrientationWhereNeitherFits) {
  const auto none =
      upright_camera(sensor(Distortion::none), "camera.yaml", {{300, 200}, 8}, "a.jpg");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, AllOf(HasSubstr("a.jpg"), HasSubstr("300 x 200"),
                                          HasSubstr("200 x 300"), HasSubstr("EXIF orientation 8"),
                                          HasSubstr("camera.yaml"), HasSubstr("640 x 480")));
}

TEST(UprightCamera, RefusesMirroredImagesByName) {
  for (const int orientation : {2, 4, 5, 7}) {
    const cv::Size size = cv::Size(640, 480);
    const auto mirrored =
        upright_camera(sensor(Distortion::none), "camera.yaml", {size, orientation}, "a.jpg");
    ASSERT_FALSE(mirrored);
    EXPECT_THAT(mirrored.error().message, AllOf(HasSubstr("a.jpg"), HasSubstr("mirrored")));
  }
}

}  // namespace
}  // namespace weft::cameras
