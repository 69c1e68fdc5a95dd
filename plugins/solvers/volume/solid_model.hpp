// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>

#include "common/cholesky/block_cholesky.hpp"

namespace weft::volume {

/// A tetrahedron of the body at rest.
struct Tetrahedron {
  std::array<std::int32_t, 4> node{};
  std::array<std::int32_t, 6> coupling{};  ///< couplings 01, 02, 03, 12, 13, 23 in SolidModel
  Eigen::Matrix<double, 3, 4> slopes;      ///< [3,4] 1/m, gradients of the shape functions at rest
  double share = 0.0;                      ///< [] of the body's volume

  /// F [3,3] of nodes [K,3] m.
  Eigen::Matrix3d gradient(const Points3& nodes_m) const {
    Eigen::Matrix3d sum = nodes_m.row(node[0]).transpose() * slopes.col(0).transpose();
    for (int a = 1; a < 4; ++a) {
      sum += nodes_m.row(node[static_cast<std::size_t>(a)]).transpose() * slopes.col(a).transpose();
    }
    return sum;
  }
};

/// A ball of the body that touches its surface on both sides, and the mean deformation in it.
struct ThickPart {
  std::vector<std::int32_t> node;      ///< [n]
  std::vector<std::int32_t> coupling;  ///< [n (n - 1) / 2] of the nodes 01, 02, ..., 12, 13, ...
  Eigen::Matrix<double, 3, Eigen::Dynamic> slopes;  ///< [3,n] 1/m, F is sum_a x_a slopes_a^T
  /// [n (n + 1) / 2] 1/m^2, upper triangle, row by row. The quadratic form of a coordinate x [n] is
  /// the mean of |x - q|^2 in squared radii, with q of second degree in the place at rest.
  std::vector<double> unevenness;
  double share = 0.0;  ///< [] of the sum of the volumes of all parts

  /// The mean F [3,3] of nodes [K,3] m.
  Eigen::Matrix3d gradient(const Points3& nodes_m) const {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (std::size_t a = 0; a < node.size(); ++a) {
      sum +=
          nodes_m.row(node[a]).transpose() * slopes.col(static_cast<Eigen::Index>(a)).transpose();
    }
    return sum;
  }
};

/// A point of the body that moves with the nodes of one tetrahedron.
struct BodyPoint {
  std::int32_t tetrahedron = 0;
  Eigen::Vector4d weights;  ///< [4] of its nodes, sum 1

  Eigen::Vector3d on(const std::vector<Tetrahedron>& tetrahedra, const Points3& nodes_m) const {
    const auto& node = tetrahedra[static_cast<std::size_t>(tetrahedron)].node;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (int a = 0; a < 4; ++a) {
      point += weights[a] * nodes_m.row(node[static_cast<std::size_t>(a)]).transpose();
    }
    return point;
  }
};

/// The data that depend on the template alone.
class SolidModel {
 public:
  /// Fails on a template without tetrahedra, with indices out of range, without volume, or with
  /// numbers that are not finite. Tetrahedra count by the share of them that the object fills
  /// (`x.weft.filled_share` [E]), all alike if the template has none.
  Result<void> build(const Template& templ);

  const Points3& nodes_m() const { return nodes_m_; }        ///< [K,3] m at rest
  const Points3& vertices_m() const { return vertices_m_; }  ///< [V,3] m at rest
  const Faces& faces() const { return faces_; }              ///< [F,3]
  const std::vector<Tetrahedron>& tetrahedra() const { return tetrahedra_; }
  const std::vector<ThickPart>& parts() const { return parts_; }
  /// Quadratic form of a coordinate of the nodes that is the mean unevenness of the parts.
  const std::vector<double>& uneven_diagonal() const { return uneven_diagonal_; }  ///< [K]
  const std::vector<double>& uneven_coupling() const { return uneven_coupling_; }  ///< [C]
  const std::vector<BodyPoint>& vertices() const { return vertices_; }             ///< [V]
  const solvers::BlockCholesky::Pairs& couplings() const { return couplings_; }
  double diagonal_m() const { return diagonal_m_; }  ///< m, of the surface at rest
  double volume_m3() const { return volume_m3_; }

  /// Where the body holds a point of a face, whose weights sum to 1.
  BodyPoint point_of(std::int32_t face, const Eigen::Vector3d& weights) const;

  /// The surface [V,3] m of nodes [K,3] m.
  Points3 surface_of(const Points3& nodes_m) const;

 private:
  Result<void> read_body(const Template& templ);
  Result<void> read_surface(const Template& templ);
  void number_couplings();
  void add_unevenness();
  Result<void> add_tetrahedron(const std::int32_t* node, std::int64_t index, double filled);
  Eigen::Vector4d weights_in(std::int32_t tetrahedron, const Eigen::Vector3d& point_m) const;

  Points3 nodes_m_, vertices_m_;
  Faces faces_;
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<ThickPart> parts_;
  std::vector<double> uneven_diagonal_, uneven_coupling_;
  std::vector<BodyPoint> vertices_;
  std::vector<std::vector<std::int32_t>> candidates_;  ///< [F] tetrahedra that may hold its points
  solvers::BlockCholesky::Pairs couplings_;
  double diagonal_m_ = 0.0, volume_m3_ = 0.0;
};

}  // namespace weft::volume
