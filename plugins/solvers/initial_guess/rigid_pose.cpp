// SPDX-License-Identifier: Apache-2.0
#include "rigid_pose.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <vector>

namespace weft::initial_guess {
namespace {

constexpr double kNoFront = 1e-3;  // mean normal over mean area

}  // namespace

std::optional<Eigen::Isometry3d> rigid_pose(std::span<const solvers::SeenPoint> points,
                                            const Camera& camera, const Points3View& rest_m) {
  std::vector<cv::Point3d> rest;
  std::vector<cv::Point2d> seen;
  for (const solvers::SeenPoint& point : points) {
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

Points3 without_tilt(const Points3View& vertices_m, const FacesView& faces) {
  Eigen::Vector3d front = Eigen::Vector3d::Zero();
  double area = 0.0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Eigen::Vector3d a = vertices_m.row(faces(f, 0));
    const Eigen::Vector3d b = vertices_m.row(faces(f, 1)), c = vertices_m.row(faces(f, 2));
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    front += normal;
    area += normal.norm();
  }
  if (!(front.norm() > kNoFront * area)) return vertices_m;
  const double side = front.z() < 0.0 ? -1.0 : 1.0;
  const Eigen::Matrix3d rotation =
      Eigen::Quaterniond::FromTwoVectors(front, side * Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::RowVector3d middle_m = vertices_m.colwise().mean();
  return ((vertices_m.rowwise() - middle_m) * rotation.transpose()).rowwise() + middle_m;
}

}  // namespace weft::initial_guess
