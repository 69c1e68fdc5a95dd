// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>
#include <weft/geometry/types.hpp>

namespace weft::volume {

/// A body-centred cubic lattice of tetrahedra around a box (as in F. Labelle, J. R. Shewchuk,
/// Isosurface stuffing, 2007). The nodes are the corners and the centres of cubes with sides of
/// `pitch_m`. A tetrahedron joins the centres of two adjacent cubes and one side of the square
/// between them; its volume is pitch^3 / 12, its edges are 0.87 and 1 pitch long. Tetrahedra and
/// nodes are numbers in a fixed order.
class Lattice {
 public:
  using Key = std::int64_t;
  /// The tetrahedron that contains a point, and the weights of its corners there, in the order of
  /// corners_of().
  struct Place {
    Key tetrahedron = 0;
    Eigen::Vector4d weights;
  };

  /// Centred on the box, with one cube more on each side.
  Lattice(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m, double pitch_m);

  /// Number of cubes of such a lattice; also for lattices that are too large to build.
  static double cubes_in(const Eigen::Vector3d& size_m, double pitch_m);

  Key tetrahedron_count() const { return 12 * cubes_.prod(); }
  /// Node keys of a tetrahedron; the volume is positive. Only for tetrahedra within the lattice.
  std::array<Key, 4> corners_of(Key tetrahedron) const;
  Eigen::Vector3d node_m(Key node) const;
  /// The tetrahedron at a point of the box. On a side between tetrahedra, the choice depends on the
  /// point's coordinates only.
  Place locate(const Eigen::Vector3d& point_m) const;
  /// The tetrahedra that a triangle enters; those that it only touches are not among them.
  std::vector<Key> cut_by(const std::array<Eigen::Vector3d, 3>& triangle_m) const;
  /// True if both cubes of a tetrahedron are in the lattice.
  bool has(Key tetrahedron) const;
  double pitch_m() const { return pitch_m_; }

 private:
  using Index3 = Eigen::Matrix<Key, 3, 1>;
  /// A tetrahedron by its cubes and one side of the square between them.
  struct Parts {
    Index3 cube;         ///< the lower one
    int along = 0;       ///< axis along which the other cube follows
    int across = 0;      ///< axis from the centre of the square to its side
    bool upper = false;  ///< the side is at the upper end of that axis
  };

  Key key_of(const Parts& parts) const;
  Parts parts_of(Key tetrahedron) const;
  Key centre_key(const Index3& cube) const;
  Key corner_key(const Index3& corner) const;

  Eigen::Vector3d origin_m_;
  double pitch_m_;
  Index3 cubes_;
};

}  // namespace weft::volume
