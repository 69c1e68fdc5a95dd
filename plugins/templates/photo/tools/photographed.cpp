// SPDX-License-Identifier: Apache-2.0
#include "photographed.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>
#include <weft/core/rng.hpp>

namespace weft::photo {
namespace {

using Colour = Eigen::Vector3d;

Eigen::Matrix3d matrix_of(const Camera& c) {
  Eigen::Matrix3d k;
  k << c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0;
  return k;
}

/// Metres on the surface's plane, from its middle, to ideal px.
Eigen::Matrix3d ideal_from_plane(const Still& still) {
  const Eigen::Matrix3d turned = (Eigen::AngleAxisd(still.roll_rad, Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(-still.tilt_rad, Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(still.turn_rad, Eigen::Vector3d::UnitY()))
                                     .toRotationMatrix();
  Eigen::Matrix3d pose;
  pose << turned.col(0), turned.col(1),
      Eigen::Vector3d(still.aside_m.x(), still.aside_m.y(), still.distance_m);
  return matrix_of(still.camera.camera) * pose;
}

Eigen::Vector2d projected(const Eigen::Matrix3d& map, double x, double y) {
  const Eigen::Vector3d at = map * Eigen::Vector3d(x, y, 1.0);
  return at.head<2>() / at.z();
}

/// The ideal pixel that the lens puts at a pixel of the photograph.
Eigen::Vector2d ideal_of(const cameras::CameraFile& camera, const Eigen::Vector2d& seen_px) {
  constexpr int kSteps = 12;
  Eigen::Vector2d ideal = seen_px;
  for (int i = 0; i < kSteps; ++i) ideal += seen_px - cameras::seen_px(camera, ideal);
  return ideal;
}

Colour print_at(const cv::Mat& print, double u, double v) {
  const double x = std::clamp(u, 0.0, print.cols - 1.0), y = std::clamp(v, 0.0, print.rows - 1.0);
  const int i = std::min(static_cast<int>(x), print.cols - 2);
  const int j = std::min(static_cast<int>(y), print.rows - 2);
  const double s = x - i, t = y - j;
  Colour colour;
  for (int c = 0; c < 3; ++c) {
    const auto level = [&](int dx, int dy) {
      return static_cast<double>(print.at<cv::Vec3b>(j + dy, i + dx)[c]);
    };
    colour[c] = (1.0 - t) * ((1.0 - s) * level(0, 0) + s * level(1, 0)) +
                t * ((1.0 - s) * level(0, 1) + s * level(1, 1));
  }
  return colour;
}

/// Planks along x have grain, and seams every 12 cm.
Colour table_at(const Still& still, const Eigen::Vector2d& at_m) {
  if (still.table == Table::plain) {
    const double shade = 6.0 * std::sin(5.0 * at_m.x() + 1.0) * std::cos(4.0 * at_m.y());
    return Colour(0.97, 1.0, 1.01) * (still.table_grey + shade);
  }
  const double wave = 0.004 * std::sin(9.0 * at_m.x()) + 0.002 * std::sin(31.0 * at_m.x() + 2.0);
  const double y = at_m.y() + wave;
  const double grain = 9.0 * std::sin(260.0 * y) + 7.0 * std::sin(611.0 * y + 1.0);
  const double from_seam_m = std::abs(std::remainder(at_m.y() + 0.03, 0.12));
  const double seam = from_seam_m < 0.0015 ? -60.0 : 0.0;
  return Colour(0.75, 0.9, 1.05) * (still.table_grey + grain + seam);
}

Colour colour_on_plane(const Still& still, const Eigen::Vector2d& at_m) {
  const double in_x = 0.5 * still.width_m - std::abs(at_m.x());
  const double in_y = 0.5 * still.height_m - std::abs(at_m.y());
  if (in_x < 0.0 || in_y < 0.0) return table_at(still, at_m);
  if (std::min(in_x, in_y) < still.margin_m) return Colour::Constant(still.paper_grey);
  const double width_m = still.width_m - 2.0 * still.margin_m;
  const double height_m = still.height_m - 2.0 * still.margin_m;
  return print_at(still.print, (at_m.x() / width_m + 0.5) * still.print.cols - 0.5,
                  (at_m.y() / height_m + 0.5) * still.print.rows - 0.5);
}

}  // namespace

cv::Mat photographed(const Still& still) {
  constexpr int kSamples = 3;
  const Camera& camera = still.camera.camera;
  const int width = static_cast<int>(camera.width_px), height = static_cast<int>(camera.height_px);
  const Eigen::Matrix3d plane_from_ideal = ideal_from_plane(still).inverse();
  Rng rng(still.seed);
  cv::Mat photo(height, width, CV_8UC3);
  std::vector<Eigen::Vector2d> above, below;  // ideal px of the corners of a row of pixels
  const auto corners_of_row = [&](int y) {
    std::vector<Eigen::Vector2d> corners;
    for (int x = 0; x <= width; ++x) corners.push_back(ideal_of(still.camera, {x - 0.5, y - 0.5}));
    return corners;
  };
  below = corners_of_row(0);
  for (int y = 0; y < height; ++y) {
    above = std::move(below);
    below = corners_of_row(y + 1);
    for (int x = 0; x < width; ++x) {
      const auto left = static_cast<std::size_t>(x), right = left + 1;
      Colour sum = Colour::Zero();
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const int column = k % kSamples, row = k / kSamples;
        const double s = (column + 0.5) / kSamples, t = (row + 0.5) / kSamples;
        const Eigen::Vector2d ideal = (1.0 - t) * ((1.0 - s) * above[left] + s * above[right]) +
                                      t * ((1.0 - s) * below[left] + s * below[right]);
        sum += colour_on_plane(still, projected(plane_from_ideal, ideal.x(), ideal.y()));
      }
      for (int c = 0; c < 3; ++c) {
        const double level = sum[c] / (kSamples * kSamples) + still.noise_grey * rng.normal();
        photo.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<std::uint8_t>(level);
      }
    }
  }
  return photo;
}

Corners true_corners(const Still& still) {
  const Eigen::Matrix3d map = ideal_from_plane(still);
  const double x = 0.5 * still.width_m, y = 0.5 * still.height_m;
  return {projected(map, -x, -y), projected(map, x, -y), projected(map, x, y),
          projected(map, -x, y)};
}

Corners true_corners_seen(const Still& still) {
  Corners corners = true_corners(still);
  for (Eigen::Vector2d& corner : corners) corner = cameras::seen_px(still.camera, corner);
  return corners;
}

cameras::CameraFile make_camera(int width, int height, bool with_lens) {
  cameras::CameraFile file;
  file.camera.width_px = width;
  file.camera.height_px = height;
  file.camera.fx = file.camera.fy = 0.86 * width;
  file.camera.cx = 0.5 * (width - 1) + 0.01 * width;
  file.camera.cy = 0.5 * (height - 1) - 0.01 * height;
  if (!with_lens) return file;
  file.model = cameras::Distortion::brown;
  file.coefficients = {-0.12, 0.04, 0.001, -0.0005, 0.0};
  return file;
}

}  // namespace weft::photo
