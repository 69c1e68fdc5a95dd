// SPDX-License-Identifier: Apache-2.0
#include "joint_pose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>

namespace weft::charts {
namespace {

/// The scale of the image in px per m: the median over pairs of distant matches of one chart.
/// Misplaced charts do not change it. 0 where all matches of each chart are in one place.
double px_per_m(const RestMatches& matches) {
  std::vector<double> scales;
  const std::size_t count = matches.chart.size();
  for (std::size_t first = 0, last = 0; first < count; first = last) {
    while (last < count && matches.chart[last] == matches.chart[first]) ++last;
    const std::size_t step = (last - first) / 2;
    for (std::size_t k = first; step > 0 && k + step < last; ++k) {
      const auto i = static_cast<Eigen::Index>(k), j = static_cast<Eigen::Index>(k + step);
      const double length_m = (matches.points_m.row(i) - matches.points_m.row(j)).norm();
      if (!(length_m > 0.0)) continue;
      scales.push_back((matches.pixels.row(i) - matches.pixels.row(j)).norm() / length_m);
    }
  }
  return scales.empty() ? 0.0 : median(scales);
}

double diagonal_m(const Template& templ) {
  const auto vertices_m = templ.vertices_m.matrix<3>();
  return (vertices_m.colwise().maxCoeff() - vertices_m.colwise().minCoeff()).norm();
}

}  // namespace

std::optional<JointPose> joint_pose(const RestMatches& matches, const Template& templ,
                                    const Camera& camera, double rigid_tolerance) {
  constexpr Eigen::Index kFewest = 6;
  constexpr int kDraws = 300;
  constexpr double kSure = 0.999;
  const double tolerance_px = rigid_tolerance * px_per_m(matches) * diagonal_m(templ);
  if (matches.pixels.rows() < kFewest || !(tolerance_px > 0.0)) return {};
  std::vector<cv::Point3d> rest;
  std::vector<cv::Point2d> seen;
  for (Eigen::Index i = 0; i < matches.pixels.rows(); ++i) {
    rest.emplace_back(matches.points_m(i, 0), matches.points_m(i, 1), matches.points_m(i, 2));
    seen.emplace_back(matches.pixels(i, 0), matches.pixels(i, 1));
  }
  const cv::Matx33d matrix(camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0);
  cv::Vec3d turn, place_m;
  std::vector<int> inliers;
  try {
    // Its random numbers have a fixed seed.
    if (!cv::solvePnPRansac(rest, seen, matrix, cv::noArray(), turn, place_m, false, kDraws,
                            static_cast<float>(tolerance_px), kSure, inliers, cv::SOLVEPNP_SQPNP)) {
      return {};
    }
  } catch (const cv::Exception&) {  // thrown for some sets without a unique pose
    return {};
  }
  cv::Matx33d rotation;
  cv::Rodrigues(turn, rotation);
  JointPose pose;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) pose.rotation(r, c) = rotation(r, c);
    pose.translation_m(r) = place_m[r];
  }
  pose.tolerance_px = tolerance_px;
  if (!pose.rotation.allFinite() || !pose.translation_m.allFinite()) return {};
  return pose;
}

Eigen::VectorXd residuals_px(const JointPose& pose, const RestMatches& matches,
                             const Camera& camera) {
  Eigen::VectorXd residuals(matches.pixels.rows());
  for (Eigen::Index i = 0; i < residuals.size(); ++i) {
    const Eigen::Vector3d at_m =
        pose.rotation * matches.points_m.row(i).transpose() + pose.translation_m;
    if (!(at_m.z() > 0.0)) {
      residuals[i] = std::numeric_limits<double>::infinity();
      continue;
    }
    residuals[i] = std::hypot(camera.fx * at_m.x() / at_m.z() + camera.cx - matches.pixels(i, 0),
                              camera.fy * at_m.y() / at_m.z() + camera.cy - matches.pixels(i, 1));
  }
  return residuals;
}

bool fits(const JointPose& pose, const RestMatches& matches, const Eigen::VectorXd& residuals_px,
          int chart) {
  constexpr double kAway = -0.5;  // cosine of 120 degrees: more than a bend explains
  std::vector<double> residuals, towards;
  for (Eigen::Index i = 0; i < residuals_px.size(); ++i) {
    if (matches.chart[to_index(i)] != chart) continue;
    residuals.push_back(residuals_px[i]);
    const Eigen::Vector3d at_m =
        pose.rotation * matches.points_m.row(i).transpose() + pose.translation_m;
    towards.push_back(-at_m.normalized().dot(pose.rotation * matches.normals.row(i).transpose()));
  }
  if (residuals.empty()) return true;
  return median(residuals) <= pose.tolerance_px && median(towards) > kAway;
}

}  // namespace weft::charts
