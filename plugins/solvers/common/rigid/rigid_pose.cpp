// SPDX-License-Identifier: Apache-2.0
#include "rigid_pose.hpp"

#include <cmath>
#include <cstddef>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <vector>

namespace weft::solvers {

namespace {

/// Points at rest and where they were seen, as OpenCV takes them.
struct Pairs {
  Pairs(std::span<const SeenPoint> points, const Points3View& rest_m) {
    for (const SeenPoint& point : points) {
      const Eigen::Vector3d at_m = point.on(rest_m);
      rest.emplace_back(at_m.x(), at_m.y(), at_m.z());
      seen.emplace_back(point.seen_px.x(), point.seen_px.y());
    }
  }
  std::vector<cv::Point3d> rest;
  std::vector<cv::Point2d> seen;
};

cv::Matx33d matrix_of(const Camera& camera) {
  return {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0};
}

}  // namespace

std::optional<Eigen::Isometry3d> rigid_pose(std::span<const SeenPoint> points, const Camera& camera,
                                            const Points3View& rest_m) {
  const auto [rest, seen] = Pairs(points, rest_m);
  const cv::Matx33d matrix = matrix_of(camera);
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

std::optional<Eigen::Isometry3d> robust_rigid_pose(std::span<const SeenPoint> points,
                                                   const Camera& camera, const Points3View& rest_m,
                                                   double tolerance_px, std::size_t fewest) {
  constexpr int kSamples = 500;
  constexpr double kSure = 0.999;
  const auto [rest, seen] = Pairs(points, rest_m);
  cv::Vec3d turn, place_m;
  std::vector<int> agreeing;
  if (!cv::solvePnPRansac(rest, seen, matrix_of(camera), cv::noArray(), turn, place_m, false,
                          kSamples, static_cast<float>(tolerance_px), kSure, agreeing,
                          cv::SOLVEPNP_EPNP)) {
    return {};
  }
  if (agreeing.size() < fewest) return {};
  std::vector<SeenPoint> kept;
  for (const int i : agreeing) kept.push_back(points[static_cast<std::size_t>(i)]);
  return rigid_pose(kept, camera, rest_m);
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
