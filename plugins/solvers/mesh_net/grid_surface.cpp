// SPDX-License-Identifier: Apache-2.0
#include "grid_surface.hpp"

#include <algorithm>

namespace weft::mesh_net {
namespace {

/// Adds the weight of node `k` of `count`. A node beyond the border is an extrapolation of those at
/// the border: quadratic where there are three, else linear.
void add_weight(int k, double weight, Eigen::RowVectorXd& weights) {
  const int count = static_cast<int>(weights.size());
  if (k >= 0 && k < count) {
    weights(k) += weight;
    return;
  }
  const int edge = k < 0 ? 0 : count - 1, inwards = k < 0 ? 1 : -1;
  if (count >= 3) {
    weights(edge) += 3.0 * weight;
    weights(edge + inwards) -= 3.0 * weight;
    weights(edge + 2 * inwards) += weight;
  } else {
    weights(edge) += 2.0 * weight;
    weights(edge + inwards) -= weight;
  }
}

/// Weights of the nodes along one axis at a share of its length.
Eigen::RowVectorXd axis_weights(double share, int count) {
  Eigen::RowVectorXd weights = Eigen::RowVectorXd::Zero(count);
  const double place = std::clamp(share, 0.0, 1.0) * (count - 1);
  const int cell = std::clamp(static_cast<int>(place), 0, count - 2);
  const double t = place - cell, t2 = t * t, t3 = t2 * t;
  add_weight(cell - 1, 0.5 * (-t3 + 2.0 * t2 - t), weights);
  add_weight(cell, 0.5 * (3.0 * t3 - 5.0 * t2 + 2.0), weights);
  add_weight(cell + 1, 0.5 * (-3.0 * t3 + 4.0 * t2 + t), weights);
  add_weight(cell + 2, 0.5 * (t3 - t2), weights);
  return weights;
}

}  // namespace

Eigen::RowVectorXd GridSurface::weights(double u, double v) const {
  const Eigen::RowVectorXd along_u = axis_weights(u, columns_), along_v = axis_weights(v, rows_);
  Eigen::RowVectorXd all(node_count());
  for (int r = 0; r < rows_; ++r) all.segment(r * columns_, columns_) = along_v(r) * along_u;
  return all;
}

}  // namespace weft::mesh_net
