// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <weft/geometry/types.hpp>

namespace weft::mesh_net {

/// Weights of the nodes of a regular grid in a smooth surface through them: cubic convolution
/// (Catmull-Rom) along both axes. Beyond the border the nodes continue quadratically, so that any
/// quadratic surface is reproduced exactly. Node (r, c) has the index r columns + c.
class GridSurface {
 public:
  GridSurface(int columns, int rows) : columns_(columns), rows_(rows) {}

  /// Weights [columns * rows] of the nodes at (u, v), shares of width and height; outside of [0, 1]
  /// those of the nearest border point.
  Eigen::RowVectorXd weights(double u, double v) const;

  /// The point at (u, v) of the surface through `nodes` [columns * rows, 3].
  Eigen::Vector3d at(const Points3& nodes, double u, double v) const {
    return (weights(u, v) * nodes).transpose();
  }

  int node_count() const { return columns_ * rows_; }

 private:
  int columns_, rows_;
};

}  // namespace weft::mesh_net
