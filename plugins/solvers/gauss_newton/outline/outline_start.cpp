// SPDX-License-Identifier: Apache-2.0
#include "outline_start.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <weft/core/stop_check.hpp>

namespace weft::gauss_newton {
namespace {

/// Area, centroid and second moments of a figure of the plane.
struct Moments {
  double area = 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();

  void add(const Eigen::Vector2d& place, double weight) {
    area += weight;
    sum += weight * place;
    squares += weight * place * place.transpose();
  }
  Eigen::Vector2d centroid() const { return sum / area; }

  /// Angle of the longest axis in -90 to 90 degrees; nothing if no axis is the longest.
  std::optional<double> axis_rad() const {
    constexpr double kRound = 0.02;
    const Eigen::Matrix2d spread = squares / area - centroid() * centroid().transpose();
    const double across = spread(0, 0) - spread(1, 1), mixed = 2.0 * spread(0, 1);
    if (!(std::hypot(across, mixed) > kRound * spread.trace())) return std::nullopt;
    return 0.5 * std::atan2(mixed, across);
  }
};

Moments moments_of(const ObjectMask& mask) {
  Moments found;
  for (std::int64_t y = 0; y < mask.foreground.dim(0); ++y) {
    worked(mask.foreground.dim(1) / 8);
    const std::uint8_t* row = mask.foreground.row(y);
    double count = 0.0, sum = 0.0, squares = 0.0;
    for (std::int64_t x = 0; x < mask.foreground.dim(1); ++x) {
      if (row[x] < 128) continue;
      const auto at = static_cast<double>(x);
      count += 1.0;
      sum += at;
      squares += at * at;
    }
    const auto down = static_cast<double>(y);
    found.area += count;
    found.sum += Eigen::Vector2d(sum, down * count);
    found.squares(0, 0) += squares;
    found.squares(0, 1) += down * sum;
    found.squares(1, 1) += down * down * count;
  }
  found.squares(1, 0) = found.squares(0, 1);
  return found;
}

/// The mesh at rest [V,3] m as a camera sees it from its front: x along that of the template, y
/// down and z away from the camera.
Points3 seen_from_front(const MeshModel& mesh) {
  Points3 normals(mesh.faces.rows(), 3);
  face_normals(mesh.rest_m, mesh.faces, normals);
  const Eigen::Vector3d front = normals.colwise().sum().transpose().normalized();
  Eigen::Vector3d right = Eigen::Vector3d::UnitX() - front.x() * front;
  if (!(right.norm() > 1e-3)) right = Eigen::Vector3d::UnitY() - front.y() * front;
  Eigen::Matrix3d axes;
  axes.row(0) = right.normalized().transpose();
  axes.row(1) = -front.cross(right.normalized()).transpose();
  axes.row(2) = -front.transpose();
  return mesh.rest_m * axes.transpose();
}

Moments moments_of(const Points3& seen_m, const Faces& faces) {
  Moments found;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const auto at = [&](Eigen::Index k) -> Eigen::Vector3d {
      return seen_m.row(faces(f, k)).transpose();
    };
    const double area = 0.5 * std::abs((at(1) - at(0)).cross(at(2) - at(0)).z());
    for (Eigen::Index k = 0; k < 3; ++k) {
      const Eigen::Vector3d middle = 0.5 * (at(k) + at((k + 1) % 3));
      found.add(middle.head<2>(), area / 3.0);  // exact for second moments
    }
  }
  return found;
}

}  // namespace

std::optional<Points3> outline_start(const ObjectMask& mask, const Pinhole& camera,
                                     const MeshModel& mesh) {
  const Points3 front_m = seen_from_front(mesh);
  const Moments seen = moments_of(mask), rest = moments_of(front_m, mesh.faces);
  if (!(seen.area > 0.0 && rest.area > 0.0)) return std::nullopt;
  const auto seen_rad = seen.axis_rad(), rest_rad = rest.axis_rad();
  double turn_rad = seen_rad && rest_rad ? *seen_rad - *rest_rad : 0.0;
  turn_rad -= std::numbers::pi * std::round(turn_rad / std::numbers::pi);
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(turn_rad).toRotationMatrix();
  const double depth_m = std::sqrt(camera.fx * camera.fy * rest.area / seen.area);
  const Eigen::Vector2d ray((seen.centroid().x() - camera.cx) / camera.fx,
                            (seen.centroid().y() - camera.cy) / camera.fy);
  Points3 placed(mesh.vertex_count(), 3);
  for (Eigen::Index v = 0; v < placed.rows(); ++v) {
    const Eigen::Vector3d at = front_m.row(v).transpose();
    const Eigen::Vector2d flat = turn * (at.head<2>() - rest.centroid()) + depth_m * ray;
    placed.row(v) << flat.x(), flat.y(), depth_m + at.z();
  }
  return placed;
}

}  // namespace weft::gauss_newton
