// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "energy.hpp"

namespace weft::gauss_newton {

/// A face, and what its observations are compared with.
struct SeenFrom {
  std::array<Eigen::Vector3d, 3> corners_m;
  std::array<double, 3> rises_m;  ///< one of each side
  Eigen::Vector3d front;          ///< its normal
  Pinhole camera;
  Trust trust;
};

/// Sums over the observations of a face.
struct FaceSums {
  /// Elements of J^T J: xx, xy, yy, xz, yz and zz for the products of weights 00, 11, 22, 01,
  /// 12, 20.
  double squares[6][6] = {};
  double slopes[3][3] = {};  ///< elements of J^T r for each weight

  /// The point is seen at (px, py) where f = 1; `j` is d(whitened residual)/d(px, py), lower.
  void add(const double* b, double inverse_z, double px, double py, const Whitening& j,
           double weight, double rx, double ry) {
    const double ax = j.xx * inverse_z, bx = j.yx * inverse_z, by = j.yy * inverse_z;
    const double az = -ax * px, bz = -(bx * px + by * py);
    const double block[6] = {
        weight * (ax * ax + bx * bx), weight * bx * by, weight * by * by,
        weight * (ax * az + bx * bz), weight * by * bz, weight * (az * az + bz * bz)};
    const double products[6] = {b[0] * b[0], b[1] * b[1], b[2] * b[2],
                                b[0] * b[1], b[1] * b[2], b[2] * b[0]};
    for (std::size_t k = 0; k < 6; ++k) {
      for (std::size_t i = 0; i < 6; ++i) squares[k][i] += products[k] * block[i];
    }
    const double gx = weight * (ax * rx + bx * ry), gy = weight * by * ry;
    const double gz = -(gx * px + gy * py);
    for (std::size_t k = 0; k < 3; ++k) {
      slopes[k][0] += b[k] * gx;
      slopes[k][1] += b[k] * gy;
      slopes[k][2] += b[k] * gz;
    }
  }

  /// Adds `count` observations of the face to the energy, and to the sums if these are wanted.
  /// False if one of them is not in front of the camera.
  bool observe(const SeenFrom& from, const Observation* seen, std::size_t count,
               bool wants_derivatives, double& energy);

  Eigen::Matrix3d block(std::size_t k) const {
    const double* s = squares[k];
    Eigen::Matrix3d result;
    result << s[0], s[1], s[3], s[1], s[2], s[4], s[3], s[4], s[5];
    return result;
  }
};

}  // namespace weft::gauss_newton
