// SPDX-License-Identifier: Apache-2.0
#include "common/cameras/undistorter.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::cameras {

Undistorter::Undistorter(const CameraFile& file) {
  if (file.model == Distortion::none) return;
  const Camera& camera = file.camera;
  const cv::Matx33d k(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const cv::Size size(static_cast<int>(camera.width_px), static_cast<int>(camera.height_px));
  if (file.model == Distortion::fisheye) {
    cv::fisheye::initUndistortRectifyMap(k, file.coefficients, cv::Matx33d::eye(), k, size,
                                         CV_16SC2, map_xy_, map_weights_);
  } else {
    cv::initUndistortRectifyMap(k, file.coefficients, cv::Matx33d::eye(), k, size, CV_16SC2,
                                map_xy_, map_weights_);
  }
}

void Undistorter::apply(const cv::Mat& image, cv::Mat& undistorted) const {
  if (!changes_images()) {
    image.copyTo(undistorted);
    return;
  }
  cv::remap(image, undistorted, map_xy_, map_weights_, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
}

cv::Mat Undistorter::nearest(const cv::Mat& image) const {
  if (!changes_images()) return image;
  cv::Mat whole = map_xy_.clone();  // the fractions are multiples of 1/32 px; halves are rounded up
  for (int y = 0; y < whole.rows; ++y) {
    ask_to_go_on();
    for (int x = 0; x < whole.cols; ++x) {
      const int fraction = map_weights_.at<std::uint16_t>(y, x);
      auto& source = whole.at<cv::Vec2s>(y, x);
      source[0] = static_cast<std::int16_t>(source[0] + (fraction % 32 >= 16));
      source[1] = static_cast<std::int16_t>(source[1] + (fraction / 32 >= 16));
    }
  }
  cv::Mat undistorted;
  cv::remap(image, undistorted, whole, cv::Mat(), cv::INTER_NEAREST, cv::BORDER_CONSTANT);
  return undistorted;
}

}  // namespace weft::cameras
