// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <weft/core/rng.hpp>

#include "support/lens.hpp"

namespace weft::testing {

/// The page on which `weft calibrate board` prints.
constexpr double kPageWidth_mm = 297.0, kPageHeight_mm = 210.0;

/// The black rectangles of a page, from its PDF, as a grey image.
inline cv::Mat picture_of_page(const std::string& pdf, int px_per_mm) {
  cv::Mat picture(static_cast<int>(kPageHeight_mm) * px_per_mm,
                  static_cast<int>(kPageWidth_mm) * px_per_mm, CV_8U, cv::Scalar(235));
  std::istringstream lines(pdf);
  for (std::string line; std::getline(lines, line);) {
    double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
    std::string shape, fill;
    std::istringstream words(line);
    if (!(words >> x >> y >> width >> height >> shape >> fill) || shape != "re") continue;
    const auto px = [&](double mm) { return static_cast<int>(std::lround(mm * px_per_mm)); };
    picture(cv::Rect({px(x), px(y)}, cv::Point(px(x + width), px(y + height)))).setTo(20);
  }
  return picture;
}

/// A page on a grey table through a lens: each pixel is the mean of some rays, slightly blurred,
/// with noise.
class PageCamera {
 public:
  /// `page`: [H,W] or [H,W,3] u8, from edge to edge; `rays_a_side`: of a pixel.
  PageCamera(const Lens& lens, cv::Mat page, double px_per_mm, int rays_a_side = 3)
      : lens_(lens),
        page_(std::move(page)),
        px_per_m_(1e3 * px_per_mm),
        rays_(rays_a_side * lens.height_px, rays_a_side * lens.width_px) {
    for (int y = 0; y < rays_.rows; ++y) {
      for (int x = 0; x < rays_.cols; ++x) {
        const Eigen::Vector2d place_px((x + 0.5) / rays_a_side - 0.5,
                                       (y + 0.5) / rays_a_side - 0.5);
        const Eigen::Vector2d ray = lens.ray(place_px);
        rays_(y, x) = {ray.x(), ray.y()};
      }
    }
  }

  /// `bend_per_m`: of the page about its vertical middle line, its sides away from the camera.
  cv::Mat image(const BoardPose& camera_from_page, Rng& rng, double bend_per_m = 0.0) const {
    const BoardPose page_from_camera = camera_from_page.inverse();
    const Eigen::Vector3d eye_m = page_from_camera.translation();
    cv::Mat_<float> u(rays_.size()), v(rays_.size());
    for (int y = 0; y < rays_.rows; ++y) {
      for (int x = 0; x < rays_.cols; ++x) {
        const Eigen::Vector3d ray =
            page_from_camera.linear() * Eigen::Vector3d(rays_(y, x)[0], rays_(y, x)[1], 1.0);
        const Eigen::Vector2d hit_m = place_on_page(eye_m, ray, bend_per_m);
        u(y, x) = static_cast<float>(hit_m.x() * px_per_m_ - 0.5);
        v(y, x) = static_cast<float>(hit_m.y() * px_per_m_ - 0.5);
      }
    }
    cv::Mat fine, image;
    cv::remap(page_, fine, u, v, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar::all(110));
    cv::resize(fine, image, {lens_.width_px, lens_.height_px}, 0, 0, cv::INTER_AREA);
    cv::GaussianBlur(image, image, {0, 0}, 0.6);
    for (int y = 0; y < image.rows; ++y) {
      std::uint8_t* const row = image.ptr<std::uint8_t>(y);
      for (int i = 0; i < image.cols * image.channels(); ++i) {
        row[i] = cv::saturate_cast<std::uint8_t>(row[i] + 1.5 * rng.normal());
      }
    }
    return image;
  }

 private:
  /// Where a ray meets the page, in metres on the page laid flat; beside it where it meets nothing.
  /// With the middle at x = 0 the page lies on bend (x^2 + z^2) = 2 z.
  Eigen::Vector2d place_on_page(const Eigen::Vector3d& eye_m, const Eigen::Vector3d& ray,
                                double bend_per_m) const {
    const double middle_m = 0.5 * page_.cols / px_per_m_;
    const double x = eye_m.x() - middle_m, z = eye_m.z();
    const double a = bend_per_m * (ray.x() * ray.x() + ray.z() * ray.z());
    const double b = bend_per_m * (x * ray.x() + z * ray.z()) - ray.z();
    const double c = bend_per_m * (x * x + z * z) - 2.0 * z;
    const double root = b * b - a * c;
    if (root < 0.0) return {-1.0, -1.0};
    const double along = c / (std::sqrt(root) - b);  // the nearer one of two
    const double at_x = x + along * ray.x(), at_z = z + along * ray.z();
    const double flat_x = bend_per_m == 0.0
                              ? at_x
                              : std::atan2(bend_per_m * at_x, 1.0 - bend_per_m * at_z) / bend_per_m;
    return {flat_x + middle_m, eye_m.y() + along * ray.y()};
  }

  Lens lens_;
  cv::Mat page_;
  double px_per_m_;
  cv::Mat_<cv::Vec2d> rays_;
};

}  // namespace weft::testing
