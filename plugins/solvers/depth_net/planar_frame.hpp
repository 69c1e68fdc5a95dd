// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

namespace weft::depth_net {

/// Images of the two axes of the template's plane in the camera frame, as columns.
using Frame = Eigen::Matrix<double, 3, 2>;

/// The orthonormal frame nearest to a 3 x 2 matrix, its polar factor. For the sum of w_i y_i x_i^T
/// it is the Q with the least sum of w_i |y_i - Q x_i|^2. Nothing if the columns are nearly
/// parallel, because the rotation is not unique then.
std::optional<Frame> nearest_frame(const Frame& sums);

}  // namespace weft::depth_net
