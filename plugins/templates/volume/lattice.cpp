// SPDX-License-Identifier: Apache-2.0
#include "lattice.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <weft/core/stop_check.hpp>

namespace weft::volume {
namespace {

constexpr Lattice::Key kPerCube = 12;

/// The axis that is neither of two.
int third_axis(int a, int b) { return 3 - a - b; }

bool is_even_order(int a, int b) { return (b - a + 3) % 3 == 1; }

/// True if some point of a triangle has all weights above a small number. `corners` are its corners
/// by their weights in a tetrahedron. The triangle is cut off where a weight is below that
/// (I. E. Sutherland, G. W. Hodgman, Reentrant polygon clipping, 1974).
bool enters(const Eigen::Matrix<double, 4, 3>& corners) {
  constexpr double kTouch = 1e-6;
  if ((corners.rowwise().maxCoeff().array() < kTouch).any()) return false;
  std::vector<Eigen::Vector4d> polygon{corners.col(0), corners.col(1), corners.col(2)}, rest;
  for (Eigen::Index k = 0; k < 4; ++k) {
    rest.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Eigen::Vector4d &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
      const double a = from(k) - kTouch, b = to(k) - kTouch;
      if (a >= 0.0) rest.push_back(from);
      if ((a >= 0.0) != (b >= 0.0)) rest.emplace_back(from + a / (a - b) * (to - from));
    }
    polygon.swap(rest);
  }
  return !polygon.empty();
}

}  // namespace

Lattice::Lattice(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m, double pitch_m)
    : pitch_m_(pitch_m) {
  cubes_ = (((high_m - low_m) / pitch_m).array().ceil().cast<Key>() + 2).max(3);
  origin_m_ = 0.5 * (low_m + high_m - pitch_m * cubes_.cast<double>());
}

double Lattice::cubes_in(const Eigen::Vector3d& size_m, double pitch_m) {
  return ((size_m / pitch_m).array().ceil() + 2.0).prod();
}

Lattice::Key Lattice::centre_key(const Index3& cube) const {
  return (cube.z() * cubes_.y() + cube.y()) * cubes_.x() + cube.x();
}

Lattice::Key Lattice::corner_key(const Index3& corner) const {
  return cubes_.prod() + (corner.z() * (cubes_.y() + 1) + corner.y()) * (cubes_.x() + 1) +
         corner.x();
}

Lattice::Key Lattice::key_of(const Parts& parts) const {
  const bool is_second = parts.across != std::min((parts.along + 1) % 3, (parts.along + 2) % 3);
  return centre_key(parts.cube) * kPerCube + 4 * parts.along + 2 * (is_second ? 1 : 0) +
         (parts.upper ? 1 : 0);
}

Lattice::Parts Lattice::parts_of(Key tetrahedron) const {
  Parts parts;
  const Key cube = tetrahedron / kPerCube;
  const int rest = static_cast<int>(tetrahedron % kPerCube);
  parts.cube << cube % cubes_.x(), cube / cubes_.x() % cubes_.y(), cube / cubes_.x() / cubes_.y();
  parts.along = rest / 4;
  const auto [first, second] = std::minmax({(parts.along + 1) % 3, (parts.along + 2) % 3});
  parts.across = rest / 2 % 2 == 0 ? first : second;
  parts.upper = rest % 2 == 1;
  return parts;
}

bool Lattice::has(Key tetrahedron) const {
  const Parts parts = parts_of(tetrahedron);
  return parts.cube(parts.along) + 1 < cubes_(parts.along);
}

std::array<Lattice::Key, 4> Lattice::corners_of(Key tetrahedron) const {
  const Parts parts = parts_of(tetrahedron);
  Index3 next = parts.cube;
  ++next(parts.along);
  Index3 low_end = next;
  if (parts.upper) ++low_end(parts.across);
  Index3 high_end = low_end;
  ++high_end(third_axis(parts.along, parts.across));
  std::array<Key, 4> corners{centre_key(parts.cube), centre_key(next), corner_key(low_end),
                             corner_key(high_end)};
  // The sides to next, across and along the square's side form a right-handed frame, or the ends
  // are exchanged.
  if (parts.upper != is_even_order(parts.along, parts.across)) std::swap(corners[2], corners[3]);
  return corners;
}

Eigen::Vector3d Lattice::node_m(Key node) const {
  const Key centres = cubes_.prod();
  const bool is_centre = node < centres;
  const Index3 count = is_centre ? cubes_ : Index3(cubes_.array() + 1);
  const Key number = is_centre ? node : node - centres;
  const Index3 index(number % count.x(), number / count.x() % count.y(),
                     number / count.x() / count.y());
  return origin_m_.array() + pitch_m_ * (index.cast<double>().array() + (is_centre ? 0.5 : 0.0));
}

Lattice::Place Lattice::locate(const Eigen::Vector3d& point_m) const {
  const Eigen::Vector3d from_origin = (point_m - origin_m_) / pitch_m_;
  Parts parts;
  for (int k = 0; k < 3; ++k) {
    parts.cube(k) = std::clamp<Key>(static_cast<Key>(std::floor(from_origin(k))), 1, cubes_(k) - 2);
  }
  const Eigen::Vector3d from_centre = from_origin.array() - parts.cube.cast<double>().array() - 0.5;
  const Eigen::Array3d distance = from_centre.array().abs();
  distance.maxCoeff(&parts.along);
  const int first = (parts.along + 1) % 3, second = (parts.along + 2) % 3;
  parts.across = distance(first) >= distance(second) ? first : second;
  parts.upper = from_centre(parts.across) >= 0.0;
  const bool is_backwards = from_centre(parts.along) < 0.0;
  if (is_backwards) --parts.cube(parts.along);
  // In the frame (along, across, side) with the own centre at 0: other centre (1, 0, 0), ends of
  // the square's side (1/2, 1/2, -1/2) and (1/2, 1/2, 1/2).
  const double along = distance(parts.along), across = distance(parts.across);
  const double side = from_centre(third_axis(parts.along, parts.across));
  Place place{key_of(parts), {1.0 - along - across, along - across, across - side, across + side}};
  if (is_backwards) std::swap(place.weights(0), place.weights(1));
  if (parts.upper != is_even_order(parts.along, parts.across)) {
    std::swap(place.weights(2), place.weights(3));
  }
  return place;
}

std::vector<Lattice::Key> Lattice::cut_by(const std::array<Eigen::Vector3d, 3>& triangle_m) const {
  const auto& [a, b, c] = triangle_m;
  const auto cube_at = [&](const Eigen::Vector3d& point_m) -> Eigen::Array<Key, 3, 1> {
    return ((point_m - origin_m_) / pitch_m_).array().floor().cast<Key>();
  };
  // The other cube of a tetrahedron follows its lower one.
  const Eigen::Array<Key, 3, 1> first = (cube_at(a.cwiseMin(b).cwiseMin(c)) - 1).max(0);
  const Eigen::Array<Key, 3, 1> last = cube_at(a.cwiseMax(b).cwiseMax(c)).min(cubes_.array() - 1);
  const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
  std::vector<Key> cut;
  for (Key z = first.z(); z <= last.z(); ++z) {
    for (Key y = first.y(); y <= last.y(); ++y) {
      for (Key x = first.x(); x <= last.x(); ++x) {
        const Key cube = centre_key({x, y, z});
        worked(3);
        constexpr double kReach = 1.5;  // pitches: no corner is further from the centre
        if (std::abs(normal.dot(node_m(cube) - a)) > kReach * pitch_m_) continue;
        for (Key t = kPerCube * cube; t < kPerCube * (cube + 1); ++t) {
          if (!has(t)) continue;
          worked(20);
          Eigen::Matrix4d nodes;
          Eigen::Matrix<double, 4, 3> corners;
          const auto node_keys = corners_of(t);
          for (int k = 0; k < 4; ++k) {
            nodes.col(k) << (node_m(node_keys[static_cast<std::size_t>(k)]) - a) / pitch_m_, 1.0;
          }
          for (int k = 0; k < 3; ++k) {
            corners.col(k) << (triangle_m[static_cast<std::size_t>(k)] - a) / pitch_m_, 1.0;
          }
          if (enters(nodes.inverse() * corners)) cut.push_back(t);
        }
      }
    }
  }
  return cut;
}

}  // namespace weft::volume
