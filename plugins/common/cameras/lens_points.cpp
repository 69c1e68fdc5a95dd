// SPDX-License-Identifier: Apache-2.0
#include "common/cameras/lens_points.hpp"

#include <opencv2/calib3d.hpp>
#include <vector>
#include <weft/core/stop_check.hpp>

namespace weft::cameras {
namespace {

/// x, y of the ray (x, y, 1) that the lens sends to each pixel.
std::vector<cv::Point2d> rays_of(const CameraFile& file, const cv::Matx33d& k,
                                 const std::vector<cv::Point2d>& pixels) {
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-12);
  std::vector<cv::Point2d> rays;
  if (file.model == Distortion::fisheye) {
    cv::fisheye::undistortPoints(pixels, rays, k, file.coefficients);
  } else {
    cv::undistortPoints(pixels, rays, k, file.coefficients, cv::noArray(), cv::noArray(), until);
  }
  return rays;
}

/// Where the lens sends these rays.
std::vector<cv::Point2d> pixels_of(const CameraFile& file, const cv::Matx33d& k,
                                   const std::vector<cv::Point2d>& rays) {
  std::vector<cv::Point2d> pixels;
  if (file.model == Distortion::fisheye) {
    cv::fisheye::distortPoints(rays, pixels, k, file.coefficients);
    return pixels;
  }
  std::vector<cv::Point3d> points;
  for (const cv::Point2d& ray : rays) points.emplace_back(ray.x, ray.y, 1.0);
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), k, file.coefficients, pixels);
  return pixels;
}

}  // namespace

Result<void> undistort_points(const CameraFile& file, const std::string& name,
                              Eigen::Ref<Points2> points_px) {
  if (file.model == Distortion::none) return {};
  const Camera& c = file.camera;
  const cv::Matx33d k(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
  std::vector<cv::Point2d> pixels;
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < points_px.rows(); ++i) {
    if (!points_px.row(i).allFinite()) continue;
    pixels.emplace_back(points_px(i, 0), points_px(i, 1));
    rows.push_back(i);
  }
  if (pixels.empty()) return {};
  ask_to_go_on();
  const std::vector<cv::Point2d> rays = rays_of(file, k, pixels);
  const std::vector<cv::Point2d> again = pixels_of(file, k, rays);
  for (std::size_t n = 0; n < rows.size(); ++n) {
    constexpr double kTolerancePx = 0.01;
    if (!(cv::norm(again[n] - pixels[n]) < kTolerancePx)) {
      return Error{Errc::invalid_data,
                   name + " (" + std::to_string(pixels[n].x) + ", " + std::to_string(pixels[n].y) +
                       ") px lies where the camera file's lens model cannot be inverted: remove "
                       "it, or give places without distortion and a camera file without"};
    }
    points_px.row(rows[n]) << c.fx * rays[n].x + c.cx, c.fy * rays[n].y + c.cy;
  }
  return {};
}

}  // namespace weft::cameras
