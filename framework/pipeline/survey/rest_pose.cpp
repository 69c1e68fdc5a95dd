// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/rest_pose.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>
#include <weft/core/statistics.hpp>

namespace weft {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

double size_of(const Points2& pixels) {
  return (pixels.colwise().maxCoeff() - pixels.colwise().minCoeff()).norm();
}

/// One step of Gauss and Newton; what is behind the camera does not count.
Vector6d gauss_newton_step(const Pinhole& camera, const Points3& points_m, const Points2& pixels,
                           const RigidAlignment& pose, double scale_px) {
  Matrix6d normal = Matrix6d::Zero();
  Vector6d right = Vector6d::Zero();
  for (Eigen::Index i = 0; i < points_m.rows(); ++i) {
    const Eigen::Vector3d turned = pose.rotation * points_m.row(i).transpose();
    const Eigen::Vector3d at = turned + pose.translation;
    if (!(at.z() > 0.0)) continue;
    const Eigen::Vector2d off = project(camera, at) - pixels.row(i).transpose();
    Eigen::Matrix<double, 2, 3> by_place;
    by_place << camera.fx / at.z(), 0.0, -camera.fx * at.x() / (at.z() * at.z()),  //
        0.0, camera.fy / at.z(), -camera.fy * at.y() / (at.z() * at.z());
    Eigen::Matrix3d by_turn;  // derivative of turned by a small rotation
    by_turn << 0.0, turned.z(), -turned.y(), -turned.z(), 0.0, turned.x(), turned.y(), -turned.x(),
        0.0;
    Eigen::Matrix<double, 2, 6> jacobian;
    jacobian << by_place * by_turn, by_place;
    const double weight = std::pow(1.0 + off.squaredNorm() / (scale_px * scale_px), -2.0);
    normal += weight * jacobian.transpose() * jacobian;
    right -= weight * jacobian.transpose() * off;
  }
  normal.diagonal() *= 1.0 + 1e-6;
  return normal.ldlt().solve(right);
}

RestPose refined(const Pinhole& camera, const Points3& points_m, const Points2& pixels,
                 RigidAlignment pose, double least_scale_px) {
  constexpr int kSteps = 50;
  constexpr double kNarrowing = 0.8;
  double scale_px = std::max(0.1 * size_of(pixels), least_scale_px);
  for (int i = 0; i < kSteps; ++i) {
    const Vector6d by = gauss_newton_step(camera, points_m, pixels, pose, scale_px);
    if (!by.allFinite()) break;
    const double angle = by.head<3>().norm();
    if (angle > 0.0) {
      pose.rotation =
          Eigen::AngleAxisd(angle, by.head<3>() / angle).toRotationMatrix() * pose.rotation;
    }
    pose.translation += by.tail<3>();
    scale_px = std::max(kNarrowing * scale_px, least_scale_px);
  }
  const Points2 seen = project_points(camera, transform_points(pose, points_m));
  std::vector<double> off_px;
  for (Eigen::Index i = 0; i < seen.rows(); ++i) {
    const double off = (seen.row(i) - pixels.row(i)).norm();
    off_px.push_back(std::isfinite(off) ? off : std::numeric_limits<double>::max());
  }
  return {pose, median(off_px)};
}

}  // namespace

Result<RestPose> rest_pose(const Pinhole& camera, const Points3& points_m, const Points2& pixels,
                           double least_scale_px) {
  constexpr Eigen::Index kFewest = 6;
  constexpr double kLean_rad = 0.6;
  if (points_m.rows() < kFewest) {
    return no_result("a pose needs " + std::to_string(kFewest) + " matches, got " +
                     std::to_string(points_m.rows()));
  }
  Points3 at_unit_depth(pixels.rows(), 3);
  at_unit_depth << (pixels.col(0).array() - camera.cx) / camera.fx,
      (pixels.col(1).array() - camera.cy) / camera.fy, Eigen::ArrayXd::Ones(pixels.rows());
  const auto facing = align_points(points_m, at_unit_depth, AlignmentKind::similarity);
  if (!facing) return facing.error();
  const Eigen::Vector3d middle = points_m.colwise().mean();
  const Eigen::Vector3d seen_middle = (*facing)(middle) / facing->scale;
  RestPose best;
  best.median_px = std::numeric_limits<double>::infinity();
  for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
    const Eigen::Vector3d lean(kLean_rad * x, kLean_rad * y, 0.0);
    RigidAlignment start;
    start.rotation = facing->rotation;
    if (lean.norm() > 0.0) {
      start.rotation = Eigen::AngleAxisd(lean.norm(), lean.normalized()) * start.rotation;
    }
    start.translation = seen_middle - start.rotation * middle;
    const RestPose found = refined(camera, points_m, pixels, start, least_scale_px);
    if (found.median_px < best.median_px) best = found;
  }
  return best;
}

}  // namespace weft
