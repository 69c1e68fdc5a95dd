// SPDX-License-Identifier: Apache-2.0
#include "planar_frame.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

namespace weft::depth_net {

std::optional<Frame> nearest_frame(const Frame& sums) {
  constexpr double kLeastRatio = 1e-6;  // between the singular values
  const Eigen::Matrix2d squares = sums.transpose() * sums;
  const double product = std::sqrt(std::max(squares.determinant(), 0.0));
  if (!(product > kLeastRatio * squares.trace())) return std::nullopt;
  // The square root of a symmetric 2 x 2 matrix A is (A + sqrt(det A) I) / its own trace.
  const double trace = std::sqrt(squares.trace() + 2.0 * product);
  const Eigen::Matrix2d root = (squares + product * Eigen::Matrix2d::Identity()) / trace;
  return Frame(sums * root.inverse());
}

}  // namespace weft::depth_net
