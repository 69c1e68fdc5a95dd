// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace weft {

using Points2 = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;      ///< [N,2]
using Points3 = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;      ///< [N,3]
using Edges = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 2, Eigen::RowMajor>;  ///< [E,2] indices
using Faces = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;  ///< [F,3] indices

/// Read-only arguments: they accept maps over foreign memory, with any row stride, without a copy.
using Points2View = Eigen::Ref<const Points2>;
using Points3View = Eigen::Ref<const Points3>;
using EdgesView = Eigen::Ref<const Edges>;
using FacesView = Eigen::Ref<const Faces>;

}  // namespace weft
