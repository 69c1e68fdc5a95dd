// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/geometry/bspline_basis.hpp>

namespace weft {

/// Integrals over one knot interval of the products of the four cubic B-splines' derivatives of
/// `order` 0 to 2 by t. Gauss-Legendre with 4 nodes is exact up to degree 7.
inline Eigen::Matrix4d spline_gram(int order) {
  constexpr std::array<double, 4> kNodes{-0.86113631159405257522, -0.33998104358485626480,
                                         0.33998104358485626480, 0.86113631159405257522};
  constexpr std::array<double, 4> kWeights{0.34785484513745385737, 0.65214515486254614263,
                                           0.65214515486254614263, 0.34785484513745385737};
  Eigen::Matrix4d gram = Eigen::Matrix4d::Zero();
  for (std::size_t node = 0; node < 4; ++node) {
    const std::array<double, 4> values = cubic_basis(0.5 * (1.0 + kNodes[node]), order);
    const Eigen::Map<const Eigen::Vector4d> b(values.data());
    const Eigen::Matrix4d product = b * b.transpose();  // bitwise symmetric
    gram += 0.5 * kWeights[node] * product;
  }
  return gram;
}

/// The bending energy of one knot cell for its 16 control points (4 * k + l, u first).
inline Eigen::Matrix<double, 16, 16> cell_bending(double su, double sv) {
  const Eigen::Matrix4d g0 = spline_gram(0), g1 = spline_gram(1), g2 = spline_gram(2);
  Eigen::Matrix<double, 16, 16> cell;
  for (Eigen::Index k = 0; k < 4; ++k) {
    for (Eigen::Index m = 0; m < 4; ++m) {
      cell.block<4, 4>(4 * k, 4 * m) = sv / (su * su * su) * g2(k, m) * g0 +
                                       2.0 / (su * sv) * g1(k, m) * g1 +
                                       su / (sv * sv * sv) * g0(k, m) * g2;
    }
  }
  return cell;
}

/// B with C^T B C = integral over the domain of W_uu^2 + 2 W_uv^2 + W_vv^2 du dv, per output
/// dimension. B is [nu*nv, nu*nv], symmetric with both halves stored, and positive semidefinite.
/// Its null space contains the affine maps. Unit: squared output unit per px^2.
inline Eigen::SparseMatrix<double> bending_matrix(const SplineDomain& domain) {
  const Eigen::Matrix<double, 16, 16> cell = cell_bending(domain.su(), domain.sv());
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(to_index(256 * domain.control_count()));
  for (int i = 0; i + 4 <= domain.nu; ++i) {
    for (int j = 0; j + 4 <= domain.nv; ++j) {
      for (int a = 0; a < 16; ++a) {
        for (int b = 0; b < 16; ++b) {
          triplets.emplace_back(static_cast<int>(domain.control_index(i + a / 4, j + a % 4)),
                                static_cast<int>(domain.control_index(i + b / 4, j + b % 4)),
                                cell(a, b));
        }
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(domain.control_count(), domain.control_count());
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

}  // namespace weft
