// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>
#include <weft/geometry/types.hpp>

namespace weft::volume {

/// Generalised winding number of a triangle mesh (A. Jacobson, L. Kavan, O. Sorkine-Hornung, Robust
/// inside-outside segmentation using generalized winding numbers, 2013): the solid angle under
/// which a point sees the faces, as a share of the sphere,
///
///   w(q) = 1 / (4 pi) sum_f Omega_f(q).
///
/// It is 1 inside and 0 outside a closed surface of counter-clockwise faces, and between both near
/// a hole. Distant groups of faces count as one dipole (G. Barill et al., Fast winding numbers for
/// soups and clouds, 2018), which changes w by less than 0.01.
class WindingNumber {
 public:
  WindingNumber(const Points3View& vertices_m, const FacesView& faces);

  double at(const Eigen::Vector3d& point_m) const;
  bool contains(const Eigen::Vector3d& point_m) const { return at(point_m) > 0.5; }

 private:
  struct Triangle {
    Eigen::Vector3d corners[3];
    Eigen::Vector3d centre() const { return (corners[0] + corners[1] + corners[2]) / 3.0; }
    Eigen::Vector3d area() const {
      return 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    }
  };
  /// A group of faces, as a dipole; `left` is 0 in a leaf.
  struct Group {
    Eigen::Vector3d centre_m, area_m2;
    double radius_m = 0.0;
    std::size_t first = 0, last = 0, left = 0, right = 0;
  };

  std::size_t add_group(std::size_t first, std::size_t last);

  std::vector<Triangle> triangles_;
  std::vector<Group> groups_;
};

}  // namespace weft::volume
