// SPDX-License-Identifier: Apache-2.0
#include "seen_points.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <string>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>

namespace weft::solvers {
namespace {

/// Least width of the matches over their length, both as standard deviations at rest.
constexpr double kNarrowest = 1e-4;
/// Standard deviation, in focal lengths, of what is seen in one place.
constexpr double kSamePlace = 1e-6;

Error mistake(std::int64_t match, const std::string& problem) {
  return {Errc::invalid_data, "match " + std::to_string(match) + " " + problem};
}

bool on_a_line(std::span<const SeenPoint> points, const Points3View& rest_m) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const SeenPoint& point : points) middle += point.on(rest_m);
  middle /= static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const SeenPoint& point : points) {
    const Eigen::Vector3d offset = point.on(rest_m) - middle;
    spread += offset * offset.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread, Eigen::EigenvaluesOnly);
  const Eigen::Vector3d& widths2 = axes.eigenvalues();
  return !(widths2[1] > kNarrowest * kNarrowest * widths2[2]);
}

}  // namespace

Result<std::vector<SeenPoint>> seen_points(const Correspondences& matches, const Template& templ,
                                           std::size_t fewest) {
  const auto faces = templ.faces.matrix<3>();
  std::vector<SeenPoint> points;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    worked_in_loop(i, 3);
    const std::int32_t face = matches.face(i);
    if (matches.kept(i) == 0 || face < 0) continue;
    if (face >= faces.rows()) {
      return mistake(i, "lies in face " + std::to_string(face) + " of a template with " +
                            std::to_string(faces.rows()) + ": use one template throughout");
    }
    SeenPoint point;
    for (int k = 0; k < 3; ++k) point.corners[to_index(k)] = faces(face, k);
    point.weights = matches.barycentrics.matrix<3>().row(i);
    point.seen_px = matches.image_px.matrix<2>().row(i);
    if (!point.weights.allFinite() || !point.seen_px.allFinite()) {
      return mistake(i, "is not finite: leave it out");
    }
    points.push_back(point);
  }
  if (points.size() < fewest) {
    return no_result("too few matches: " + std::to_string(points.size()) +
                     " kept on the mesh of at least " + std::to_string(fewest));
  }
  if (on_a_line(points, templ.vertices_m.matrix<3>())) {
    return no_result("the matches lie on a line of the template");
  }
  return points;
}

Eigen::Matrix<double, 2, 3> reprojection_rows(const Camera& camera,
                                              const Eigen::Vector2d& seen_px) {
  Eigen::Matrix<double, 2, 3> rows;
  rows << camera.fx, 0.0, camera.cx - seen_px.x(), 0.0, camera.fy, camera.cy - seen_px.y();
  return rows;
}

std::vector<double> reprojection_errors_px(std::span<const SeenPoint> points, const Camera& camera,
                                           const Points3View& vertices_m) {
  const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  std::vector<double> errors_px;
  errors_px.reserve(points.size());
  for (const SeenPoint& point : points) {
    worked_in_loop(static_cast<std::int64_t>(errors_px.size()), 3);
    const double error_px = (project(pinhole, point.on(vertices_m)) - point.seen_px).norm();
    const bool in_front = error_px >= 0.0;  // false for NaN
    errors_px.push_back(in_front ? error_px : std::numeric_limits<double>::infinity());
  }
  return errors_px;
}

std::vector<SeenPoint> points_within(std::span<const SeenPoint> points, const Camera& camera,
                                     const Points3View& vertices_m, double radius_px) {
  const std::vector<double> errors_px = reprojection_errors_px(points, camera, vertices_m);
  std::vector<SeenPoint> near;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (errors_px[i] <= radius_px) near.push_back(points[i]);
  }
  return near;
}

double frontal_distance_m(std::span<const SeenPoint> points, const Camera& camera,
                          const Points3View& rest_m) {
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  const auto count = static_cast<double>(points.size());
  const Eigen::Vector2d focal_px(camera.fx, camera.fy);
  for (const SeenPoint& point : points) {
    middle_m += point.on(rest_m) / count;
    middle += point.seen_px.cwiseQuotient(focal_px) / count;
  }
  double size2_m2 = 0.0, seen2 = 0.0;
  for (const SeenPoint& point : points) {
    size2_m2 += (point.on(rest_m) - middle_m).squaredNorm();
    seen2 += (point.seen_px.cwiseQuotient(focal_px) - middle).squaredNorm();
  }
  const bool coincide = !(seen2 > kSamePlace * kSamePlace * count);
  return coincide ? std::numeric_limits<double>::infinity() : std::sqrt(size2_m2 / seen2);
}

std::vector<std::uint8_t> vertices_seen(std::span<const SeenPoint> points,
                                        Eigen::Index vertex_count) {
  std::vector<std::uint8_t> seen(to_index(vertex_count), 0);
  for (const SeenPoint& point : points) {
    for (const std::int32_t v : point.corners) seen[to_index(v)] = 1;
  }
  return seen;
}

}  // namespace weft::solvers
