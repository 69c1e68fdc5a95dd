// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/geometry/types.hpp>

#include "common/warp_grid.hpp"

namespace weft::chhatkuli_stable {

constexpr double kPitch = 3e-4;  // m/px
constexpr double kWidthPx = 960.0, kHeightPx = 576.0;

/// Position and derivative by px, by formula.
struct Exact {
  Eigen::Vector3d at;
  Eigen::Matrix<double, 3, 2> derivative;
};

using Surface = std::function<Exact(double u_px, double v_px)>;

/// A cylinder about the y axis whose hollow is away from the camera, a plane for curvature 0.
inline Surface cylinder(double curvature_per_m) {
  return [=](double u_px, double v_px) {
    const double x = kPitch * (u_px - kWidthPx / 2), turn = curvature_per_m * x;
    Eigen::Vector3d at(x, kPitch * (v_px - kHeightPx / 2), 0.0);
    if (curvature_per_m != 0.0) {
      at.x() = std::sin(turn) / curvature_per_m;
      at.z() = (1.0 - std::cos(turn)) / curvature_per_m;
    }
    Eigen::Matrix<double, 3, 2> derivative;
    derivative << kPitch * std::cos(turn), 0.0, 0.0, kPitch, kPitch * std::sin(turn), 0.0;
    return Exact{at, derivative};
  };
}

/// The surface rolled to a cone whose apex is 0.4 m above its middle and whose axis is away from
/// the camera.
inline Surface cone(double half_angle_rad) {
  return [=](double u_px, double v_px) {
    const double x = kPitch * (u_px - kWidthPx / 2), y = 0.4 + kPitch * (v_px - kHeightPx / 2);
    const double radius = std::hypot(x, y), sine = std::sin(half_angle_rad);
    const double turn = std::atan2(x, y) / sine;
    const Eigen::Vector3d out(std::sin(turn), 0.0, -std::cos(turn));
    const Eigen::Vector3d around(std::cos(turn), 0.0, std::sin(turn));
    const Eigen::Vector3d line = sine * out + std::cos(half_angle_rad) * Eigen::Vector3d::UnitY();
    // d(radius) = (x dx + y dy) / radius, radius d(turn) = (y dx - x dy) / (radius sine)
    Eigen::Matrix<double, 3, 2> derivative;
    derivative.col(0) = kPitch / radius * (x * line + y * around);
    derivative.col(1) = kPitch / radius * (y * line - x * around);
    return Exact{radius * line - Eigen::Vector3d(0.0, 0.4, -0.4 * sine), derivative};
  };
}

inline Eigen::Isometry3d pose_of(double distance_m, double tilt_rad) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(0.02, -0.01, distance_m));
  pose.rotate(Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d(1, 2, 1).normalized()));
  return pose;
}

/// The reading of an exact warp on a grid, and the points that it is from, [n,3] m.
struct ExactReading {
  std::vector<solvers::WarpPlace> places;
  Points3 truth_m;
};

inline ExactReading read_exactly(const Surface& surface, const Eigen::Isometry3d& pose,
                                 int grid = 32) {
  ExactReading read;
  read.truth_m.resize(grid * grid, 3);
  for (int i = 0; i < grid; ++i) {
    for (int j = 0; j < grid; ++j) {
      const Eigen::Vector2d place((i + 0.5) / grid * kWidthPx, (j + 0.5) / grid * kHeightPx);
      const Exact exact = surface(place.x(), place.y());
      const Eigen::Vector3d at = pose * exact.at;
      const Eigen::Matrix<double, 3, 2> derivative = pose.linear() * exact.derivative;
      const Eigen::Vector2d eta = at.head<2>() / at.z();
      const Eigen::Matrix2d jacobian = (derivative.topRows<2>() - eta * derivative.row(2)) / at.z();
      read.truth_m.row(static_cast<Eigen::Index>(read.places.size())) = at.transpose();
      read.places.push_back(
          {i, j, place, kPitch * kPitch * Eigen::Matrix2d::Identity(), eta, jacobian});
    }
  }
  return read;
}

/// Each derivative is multiplied by a matrix that differs from I by numbers of that deviation.
inline void disturb(std::vector<solvers::WarpPlace>& places, double deviation, Rng& rng) {
  for (solvers::WarpPlace& place : places) {
    Eigen::Matrix2d error = Eigen::Matrix2d::Identity();
    for (double& entry : error.reshaped()) entry += deviation * rng.normal();
    place.jacobian = error * place.jacobian;
  }
}

}  // namespace weft::chhatkuli_stable
