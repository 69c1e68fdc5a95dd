// SPDX-License-Identifier: Apache-2.0
#include "lab/calibration/view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <weft/core/index.hpp>

namespace weft::calibration {
namespace {

/// Relative to the longer side of the image: an angle of view of 53 degrees.
constexpr double kUsualFocal = 1.0;

/// The rotation of the board, by a camera that is about right; the identity where there is none.
cv::Matx33d rotation_of(const View& view, const ImageSize& size) {
  std::vector<cv::Point3d> board;
  std::vector<cv::Point2d> image;
  for (Eigen::Index i = 0; i < view.board_m.rows(); ++i) {
    board.emplace_back(view.board_m(i, 0), view.board_m(i, 1), 0.0);
    image.emplace_back(view.image_px(i, 0), view.image_px(i, 1));
  }
  const double focal_px = kUsualFocal * std::max(size.width_px, size.height_px);
  const cv::Matx33d camera(focal_px, 0.0, 0.5 * (size.width_px - 1), 0.0, focal_px,
                           0.5 * (size.height_px - 1), 0.0, 0.0, 1.0);
  cv::Vec3d rotation, translation;
  cv::Matx33d matrix = cv::Matx33d::eye();
  try {
    if (!cv::solvePnP(board, image, camera, cv::noArray(), rotation, translation, false,
                      cv::SOLVEPNP_IPPE)) {
      return matrix;
    }
    cv::Rodrigues(rotation, matrix);
  } catch (const cv::Exception&) {  // corners on a line: nothing is known of its tilt
  }
  return matrix;
}

}  // namespace

// The depth of a plane grows by -n_x / n_z along x and by -n_y / n_z along y, however the board is
// turned within it.
Eigen::Vector2d tilt_of(const Eigen::Vector3d& normal) {
  const double sign = normal.z() < 0.0 ? -1.0 : 1.0;
  return {std::atan2(-sign * normal.x(), sign * normal.z()),
          std::atan2(-sign * normal.y(), sign * normal.z())};
}

Placement placement_of(const View& view, const ImageSize& size) {
  Placement placement;
  const Eigen::Vector2d lowest = view.image_px.colwise().minCoeff();
  const Eigen::Vector2d highest = view.image_px.colwise().maxCoeff();
  const Eigen::Vector2d whole(size.width_px, size.height_px);
  placement.centre = (0.5 * (lowest + highest)).array() / whole.array();
  placement.size = std::sqrt(((highest - lowest).array() / whole.array()).prod());
  const cv::Matx33d turned = rotation_of(view, size);
  placement.tilt_rad = tilt_of({turned(0, 2), turned(1, 2), turned(2, 2)});
  return placement;
}

double difference(const Placement& a, const Placement& b) {
  constexpr double kShare = 1.0 / 3.0, kAngle_rad = std::numbers::pi / 8.0;
  return std::sqrt((a.centre - b.centre).squaredNorm() / (kShare * kShare) +
                   (a.size - b.size) * (a.size - b.size) / (kShare * kShare) +
                   (a.tilt_rad - b.tilt_rad).squaredNorm() / (kAngle_rad * kAngle_rad));
}

std::vector<std::size_t> choose_views(const std::vector<View>& views, const ImageSize& size,
                                      std::size_t most) {
  std::vector<std::size_t> chosen;
  if (views.empty()) return chosen;
  std::vector<Placement> placements;
  for (const View& view : views) placements.push_back(placement_of(view, size));
  const auto corners = [&](std::size_t i) { return static_cast<double>(views[i].board_m.rows()); };
  std::vector<double> farness(views.size(), std::numeric_limits<double>::max());
  std::size_t next = 0;
  for (std::size_t i = 1; i < views.size(); ++i) {
    if (corners(i) > corners(next)) next = i;
  }
  while (chosen.size() < std::min(most, views.size())) {
    chosen.push_back(next);
    farness[next] = -1.0;
    for (std::size_t i = 0; i < views.size(); ++i) {
      // If views are equally far, the one with more corners wins.
      const double far = difference(placements[i], placements[next]) * std::sqrt(corners(i));
      farness[i] = std::min(farness[i], far);
    }
    next = to_index(std::max_element(farness.begin(), farness.end()) - farness.begin());
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace weft::calibration
