// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace weft {

using Points2 =
    Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;  ///< [N,2] rows of points
using Points3 =
    Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;  ///< [N,3] rows of points
using Edges =
    Eigen::Matrix<std::int32_t, Eigen::Dynamic, 2, Eigen::RowMajor>;  ///< [E,2] vertex indices
using Faces =
    Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;  ///< [F,3] vertex indices

/// Read-only arguments. They accept maps over external memory with any row stride, without a copy.
using Points2View = Eigen::Ref<const Points2>;
using Points3View = Eigen::Ref<const Points3>;
using EdgesView = Eigen::Ref<const Edges>;
using FacesView = Eigen::Ref<const Faces>;

}  // namespace weft
