// SPDX-License-Identifier: Apache-2.0
#include "samples/random_sheet.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <weft/generators/developable.hpp>

#include "folded_cone.hpp"
#include "handle_pair.hpp"

namespace weft::frex {
namespace {

/// A curvature over an extent, in m or in rad: a constant, and up to two waves of less than it.
SheetBend random_bend(double size, double extent, Rng& rng) {
  constexpr double kUsual_rad = 0.9, kLargest_rad = 2.2, kWave_rad = 0.5;
  constexpr double kFlatShare = 0.15, kFlat = 0.1;
  if (rng.uniform() < kFlatShare) size *= kFlat;
  const double turn_rad = std::clamp(kUsual_rad * rng.normal(), -kLargest_rad, kLargest_rad);
  SheetBend bend;
  bend.constant_per_m = size * turn_rad / extent;
  const std::uint32_t waves = rng.below(3);
  for (std::uint32_t k = 0; k < waves; ++k) {
    const double period = extent * rng.uniform(0.35, 1.5);
    const double swing_rad = size * kWave_rad * rng.uniform();
    bend.waves.push_back({2.0 * M_PI * swing_rad / period, period, rng.uniform(0.0, 2.0 * M_PI)});
  }
  return bend;
}

Points2 centred(const Points2& flat_m) {
  const Eigen::RowVector2d middle_m =
      0.5 * (flat_m.colwise().minCoeff() + flat_m.colwise().maxCoeff());
  return flat_m.rowwise() - middle_m;
}

}  // namespace

RandomSheet::RandomSheet(const SheetRanges& ranges, const Points2& flat_m, const Camera& camera)
    : ranges_(ranges),
      camera_(camera),
      pinhole_{camera.fx, camera.fy, camera.cx, camera.cy},
      centred_m_(centred(flat_m)),
      width_m_(2.0 * centred_m_.col(0).maxCoeff()),
      diagonal_m_(2.0 * centred_m_.rowwise().norm().maxCoeff()) {}

Points3 RandomSheet::draw(Rng& rng) const {
  constexpr int kTries = 40;
  constexpr double kMostTilt_rad = M_PI / 3.0;
  Points3 local_m = shape(rng);
  local_m.rowwise() -= local_m.colwise().mean().eval();
  const double tilt_rad = std::min(std::abs(ranges_.tilt_rad * rng.normal()), kMostTilt_rad);
  const double about_rad = rng.uniform(0.0, 2.0 * M_PI);
  const Eigen::Matrix3d turn =
      rotation_of(tilt_rad * Eigen::Vector3d(std::cos(about_rad), std::sin(about_rad), 0.0)) *
      rotation_of(ranges_.roll_rad * rng.normal() * Eigen::Vector3d::UnitZ());
  local_m = (local_m * turn.transpose()).eval();
  const double fitting_m = camera_.fx * width_m_ / static_cast<double>(camera_.width_px);
  const double distance_m =
      fitting_m * std::exp(rng.uniform(std::log(ranges_.nearest), std::log(ranges_.farthest)));
  for (int k = 0; k < kTries; ++k) {
    const double x_px = rng.uniform(0.0, static_cast<double>(camera_.width_px));
    const double y_px = rng.uniform(0.0, static_cast<double>(camera_.height_px));
    const Eigen::RowVector3d middle_m(distance_m * (x_px - camera_.cx) / camera_.fx,
                                      distance_m * (y_px - camera_.cy) / camera_.fy, distance_m);
    const Points3 vertices_m = local_m.rowwise() + middle_m;
    if (is_inside(vertices_m)) return vertices_m;
  }
  // It is too large for the image: the middle of the surface is in the middle of the image, and no
  // vertex comes near the camera.
  const double safe_m = std::max(distance_m, 0.2 * distance_m - local_m.col(2).minCoeff());
  return local_m.rowwise() + Eigen::RowVector3d(0.0, 0.0, safe_m);
}

Points3 RandomSheet::shape(Rng& rng) const {
  constexpr double kConeShare = 0.35;
  return rng.uniform() < kConeShare ? cone(rng) : cylinder(rng);
}

Points3 RandomSheet::cylinder(Rng& rng) const {
  SheetBend bend = random_bend(ranges_.bend, diagonal_m_, rng);
  bend.ruling_angle_rad = rng.uniform(0.0, M_PI);
  const auto sheet = DevelopableSheet::create(Eigen::Vector2d::Zero(), 0.5 * diagonal_m_,
                                              std::move(bend), Eigen::Isometry3d::Identity());
  Points3 bent_m = Points3::Zero(centred_m_.rows(), 3);
  bent_m.leftCols<2>() = centred_m_;
  if (!sheet) return bent_m;  // flat; the draws above are all legal
  for (Eigen::Index v = 0; v < bent_m.rows(); ++v) {
    bent_m.row(v) = sheet->bent(centred_m_(v, 0), centred_m_(v, 1)).transpose();
  }
  return bent_m;
}

/// The apex lies beside the surface, so that its directions from there span less than half a turn.
Points3 RandomSheet::cone(Rng& rng) const {
  const double direction_rad = rng.uniform(0.0, 2.0 * M_PI);
  const double away_m = diagonal_m_ * rng.uniform(0.6, 2.0);
  const Eigen::Vector2d apex_m =
      -away_m * Eigen::Vector2d(std::cos(direction_rad), std::sin(direction_rad));
  const double reach_rad = std::asin(std::min(0.5 * diagonal_m_ / away_m, 1.0));
  const SheetBend bend = random_bend(ranges_.bend, 2.0 * reach_rad, rng);
  const FoldedCone cone(apex_m, direction_rad, reach_rad,
                        [&](double angle_rad) { return bend.curvature_per_m(angle_rad); });
  Points3 bent_m(centred_m_.rows(), 3);
  for (Eigen::Index v = 0; v < bent_m.rows(); ++v) {
    bent_m.row(v) = cone.at(centred_m_.row(v).transpose(), 0.0).transpose();
  }
  return bent_m;
}

bool RandomSheet::is_inside(const Points3& vertices_m) const {
  constexpr double kShare = 0.75, kNearest = 0.2;
  const double mean_m = vertices_m.col(2).mean();
  if (vertices_m.col(2).minCoeff() < kNearest * mean_m) return false;
  Eigen::Index inside = 0;
  for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
    const Eigen::Vector2d pixel = project(pinhole_, vertices_m.row(v).transpose());
    if (camera_.shows(pixel.x(), pixel.y())) ++inside;
  }
  return static_cast<double>(inside) >= kShare * static_cast<double>(vertices_m.rows());
}

}  // namespace weft::frex
