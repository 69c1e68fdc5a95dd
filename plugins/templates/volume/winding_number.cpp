// SPDX-License-Identifier: Apache-2.0
#include "winding_number.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::volume {
namespace {

constexpr std::size_t kLeafFaces = 2;
constexpr double kDistant = 4.0;  // distance of a group that is one dipole, in its radii

/// Solid angle of a triangle seen from the origin (A. van Oosterom, J. Strackee, The solid angle of
/// a plane triangle, 1983); positive if the triangle is clockwise as seen from there.
double solid_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return 2.0 * std::atan2(a.dot(b.cross(c)), below);
}

}  // namespace

WindingNumber::WindingNumber(const Points3View& vertices_m, const FacesView& faces) {
  triangles_.resize(to_index(faces.rows()));
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) triangles_[to_index(f)].corners[k] = vertices_m.row(faces(f, k));
  }
  if (!triangles_.empty()) add_group(0, triangles_.size());
}

std::size_t WindingNumber::add_group(std::size_t first, std::size_t last) {
  worked(static_cast<std::int64_t>(20 * (last - first)));
  Group group;
  group.first = first, group.last = last;
  group.centre_m.setZero(), group.area_m2.setZero();
  Eigen::AlignedBox3d centres;
  double area_m2 = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    const Eigen::Vector3d centre_m = triangles_[i].centre(), own_m2 = triangles_[i].area();
    // The least number keeps the centre finite where no face has an area.
    const double weight = own_m2.norm() + 1e-300;
    group.centre_m += weight * centre_m, area_m2 += weight;
    group.area_m2 += own_m2;
    centres.extend(centre_m);
  }
  group.centre_m /= area_m2;
  for (std::size_t i = first; i < last; ++i) {
    for (const Eigen::Vector3d& corner : triangles_[i].corners) {
      group.radius_m = std::max(group.radius_m, (corner - group.centre_m).norm());
    }
  }
  const std::size_t own = groups_.size();
  groups_.push_back(group);
  if (last - first <= kLeafFaces) return own;
  Eigen::Index axis = 0;
  centres.sizes().maxCoeff(&axis);
  const std::size_t middle = first + (last - first) / 2;
  const auto at = [this](std::size_t i) {
    return triangles_.begin() + static_cast<std::ptrdiff_t>(i);
  };
  std::nth_element(at(first), at(middle), at(last), [&](const Triangle& a, const Triangle& b) {
    return a.centre()(axis) < b.centre()(axis);
  });
  const std::size_t left = add_group(first, middle);
  const std::size_t right = add_group(middle, last);
  groups_[own].left = left, groups_[own].right = right;
  return own;
}

double WindingNumber::at(const Eigen::Vector3d& point_m) const {
  if (groups_.empty()) return 0.0;
  double solid_angle_rad = 0.0;
  // Halving the faces needs one place per level: 64 are enough for any number of them.
  std::array<std::size_t, 64> open{0};
  std::size_t count = 1;
  while (count > 0) {
    const Group& group = groups_[open[--count]];
    const Eigen::Vector3d away_m = group.centre_m - point_m;
    const double distance_m = away_m.norm();
    if (distance_m > kDistant * group.radius_m) {
      solid_angle_rad += group.area_m2.dot(away_m) / (distance_m * distance_m * distance_m);
      continue;
    }
    if (group.left != 0) {
      open[count++] = group.right, open[count++] = group.left;
      continue;
    }
    for (std::size_t i = group.first; i < group.last; ++i) {
      const auto& [a, b, c] = triangles_[i].corners;
      solid_angle_rad += solid_angle(a - point_m, b - point_m, c - point_m);
    }
  }
  return solid_angle_rad / (4.0 * M_PI);
}

}  // namespace weft::volume
