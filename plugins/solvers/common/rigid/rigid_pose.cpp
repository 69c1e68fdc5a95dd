// SPDX-License-Identifier: Apache-2.0
#include "rigid_pose.hpp"

#include <cmath>
#include <cstddef>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <vector>

namespace weft::solvers {

std::optional<Eigen::Isometry3d> rigid_pose(std::span<const SeenPoint> points, const Camera& camera,
                                            const Points3View& rest_m) {
  std::vector<cv::Point3d> rest;
  std::vector<cv::Point2d> seen;
  for (const SeenPoint& point : points) {
    const Eigen::Vector3d at_m = point.on(rest_m);
    rest.emplace_back(at_m.x(), at_m.y(), at_m.z());
    seen.emplace_back(point.seen_px.x(), point.seen_px.y());
  }
  const cv::Matx33d matrix(camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0);
  cv::Vec3d turn, place_m;
  if (!cv::solvePnP(rest, seen, matrix, cv::noArray(), turn, place_m, false, cv::SOLVEPNP_SQPNP)) {
    return {};
  }
  cv::solvePnPRefineLM(rest, seen, matrix, cv::noArray(), turn, place_m);
  cv::Matx33d rotation;
  cv::Rodrigues(turn, rotation);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) pose(r, c) = rotation(r, c);
    pose(r, 3) = place_m[r];
  }
  if (!pose.matrix().allFinite()) return {};
  return pose;
}

std::optional<Points3> posed_at_rest(std::span<const SeenPoint> points, const Camera& camera,
                                     const Points3View& rest_m) {
  constexpr std::size_t kFewestPoints = 6;
  if (points.size() < kFewestPoints) return {};
  if (!std::isfinite(frontal_distance_m(points, camera, rest_m))) return {};
  const auto camera_from_template = rigid_pose(points, camera, rest_m);
  if (!camera_from_template) return {};
  return Points3((rest_m * camera_from_template->linear().transpose()).rowwise() +
                 camera_from_template->translation().transpose());
}

}  // namespace weft::solvers
