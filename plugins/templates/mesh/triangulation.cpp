// SPDX-License-Identifier: Apache-2.0
#include "triangulation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::mesh {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Cuts off the ears of a polygon until nothing is left.
class Ears {
 public:
  explicit Ears(std::vector<Vector2d> points) : points_(std::move(points)) {
    const auto count = points_.size();
    Eigen::AlignedBox2d box;
    for (const Vector2d& point : points_) box.extend(point);
    least_area_ = 1e-12 * box.diagonal().squaredNorm();
    for (std::size_t i = 0; i < count; ++i) {
      before_.push_back((i + count - 1) % count);
      behind_.push_back((i + 1) % count);
    }
    for (std::size_t i = 0; i < count; ++i) left_.push_back(i);
    quality_.assign(count, 0.0);
    for (std::size_t i = 0; i < count; ++i) quality_[i] = quality_of(i);
  }

  /// The corners of the triangles; fewer than expected where the polygon crosses itself.
  std::vector<std::array<std::size_t, 3>> cut() {
    std::vector<std::array<std::size_t, 3>> triangles;
    while (left_.size() >= 3) {
      worked_in_loop(static_cast<std::int64_t>(triangles.size()), 8);
      const auto best =
          std::max_element(left_.begin(), left_.end(),
                           [&](std::size_t a, std::size_t b) { return quality_[a] < quality_[b]; });
      if (!(quality_[*best] > kNoEar)) return triangles;
      const std::size_t ear = *best, a = before_[ear], b = behind_[ear];
      triangles.push_back({a, ear, b});
      left_.erase(best);
      behind_[a] = b;
      before_[b] = a;
      quality_[a] = quality_of(a);
      quality_[b] = quality_of(b);
    }
    return triangles;
  }

 private:
  static constexpr double kNoEar = -1.0;

  double area_at(std::size_t i) const {
    return 0.5 * cross(points_[i] - points_[before_[i]], points_[behind_[i]] - points_[i]);
  }

  /// The least angle of the triangle at corner i, 0 where it has no area, kNoEar where it is no
  /// ear.
  double quality_of(std::size_t i) const {
    const Vector2d &a = points_[before_[i]], &b = points_[i], &c = points_[behind_[i]];
    const double area = area_at(i);
    if (area < -least_area_) return kNoEar;
    if (area <= least_area_) return left_.size() > 3 && is_spike(a, b, c) ? kNoEar : 0.0;
    for (const std::size_t other : left_) {
      const Vector2d& p = points_[other];
      // Polygons with a hole pass twice through the ends of the slit that leads to it.
      if (p == a || p == b || p == c || area_at(other) > least_area_) continue;
      const double least =
          std::min({cross(b - a, p - a), cross(c - b, p - b), cross(a - c, p - c)});
      if (least >= 0.0) return kNoEar;
    }
    const auto angle = [](const Vector2d& at, const Vector2d& one, const Vector2d& other) {
      const Vector2d u = one - at, v = other - at;
      return std::atan2(std::abs(cross(u, v)), u.dot(v));
    };
    return std::min({angle(a, b, c), angle(b, c, a), angle(c, a, b)});
  }

  /// True if the outline turns back on itself at b.
  static bool is_spike(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
    return (a - b).dot(c - b) > 0.0;
  }

  std::vector<Vector2d> points_;
  std::vector<std::size_t> before_, behind_, left_;
  std::vector<double> quality_;
  double least_area_ = 0.0;
};

/// Twice the area of a polygon, as a vector along its normal.
Vector3d newell(const std::vector<Vector3d>& corners) {
  Vector3d normal = Vector3d::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3d a = corners[i] - corners[0];
    normal += a.cross(corners[(i + 1) % corners.size()] - corners[0]);
  }
  return normal;
}

bool is_fan_sound(const std::vector<Vector3d>& corners, const Vector3d& normal) {
  const double least = 1e-12 * normal.squaredNorm();
  for (std::size_t k = 2; k < corners.size(); ++k) {
    const Vector3d area = (corners[k - 1] - corners[0]).cross(corners[k] - corners[0]);
    if (!(area.dot(normal) > least)) return false;
  }
  return true;
}

/// The corners seen against the normal, so that they turn counter-clockwise.
std::vector<Vector2d> laid_flat(const std::vector<Vector3d>& corners, const Vector3d& normal) {
  const Vector3d right = normal.unitOrthogonal(), up = normal.normalized().cross(right);
  std::vector<Vector2d> flat;
  for (const Vector3d& corner : corners) {
    flat.emplace_back(right.dot(corner - corners[0]), up.dot(corner - corners[0]));
  }
  return flat;
}

/// `faces` are the fan of one polygon.
Result<void> cut_polygon(MeshFile& file, std::size_t begin, std::size_t end) {
  constexpr std::size_t kMost = 10'000;  // cutting takes a time that grows with the square
  std::vector<MeshFile::Corner> corners{file.faces[begin].corners[0]};
  for (std::size_t f = begin; f < end; ++f) corners.push_back(file.faces[f].corners[1]);
  corners.push_back(file.faces[end - 1].corners[2]);
  std::vector<Vector3d> places;
  for (const MeshFile::Corner& corner : corners) {
    places.push_back(file.positions[to_index(corner.position)]);
  }
  const Vector3d normal = newell(places);
  // A face without area is invisible: its triangles are removed later.
  if (!(normal.norm() > 0.0) || !normal.allFinite() || is_fan_sound(places, normal)) return {};
  if (corners.size() > kMost) {
    return file.mistake(file.faces[begin],
                        "has " + std::to_string(corners.size()) +
                            " corners and is not convex: cut it into triangles before the export");
  }
  const auto triangles = Ears(laid_flat(places, normal)).cut();
  if (triangles.size() != end - begin) {
    return file.mistake(file.faces[begin],
                        "has an outline that crosses itself: correct its corners, or cut it into "
                        "triangles before the export");
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      file.faces[begin + t].corners[k] = corners[triangles[t][k]];
    }
  }
  return {};
}

}  // namespace

Result<void> cut_polygons(MeshFile& file) {
  for (std::size_t begin = 0; begin < file.faces.size();) {
    std::size_t end = begin + 1;
    while (end < file.faces.size() && file.faces[end].count == file.faces[begin].count) ++end;
    if (end - begin > 1) {
      if (auto cut = cut_polygon(file, begin, end); !cut) return cut;
    }
    begin = end;
  }
  return {};
}

}  // namespace weft::mesh
