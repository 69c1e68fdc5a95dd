// SPDX-License-Identifier: Apache-2.0
#include "bend_smoother.hpp"

#include <cstddef>
#include <weft/geometry/rigid_alignment.hpp>

namespace weft::solvers {

void BendSmoother::build(const Points3View& rest_m, const MeshTopology& topology,
                         const std::vector<BendingHinge>& hinges, double smoothing) {
  smooths_ = smoothing > 0.0;
  if (!smooths_) return;
  rest_m_ = rest_m;
  const double edge_m = mean_edge_length(rest_m_, topology.edges);
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index v = 0; v < rest_m_.rows(); ++v) entries.emplace_back(v, v, 1.0);
  for (const BendingHinge& hinge : hinges) {
    const double weight = smoothing * edge_m * edge_m * hinge.weight;
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t c = 0; c < 4; ++c) {
        entries.emplace_back(hinge.vertex[r], hinge.vertex[c],
                             weight * hinge.coefficient_per_m[r] * hinge.coefficient_per_m[c]);
      }
    }
  }
  Eigen::SparseMatrix<double> normal(rest_m_.rows(), rest_m_.rows());
  normal.setFromTriplets(entries.begin(), entries.end());
  factor_.compute(normal);
}

Points3 BendSmoother::smoothed(const Points3View& rough_m) const {
  if (!smooths_) return rough_m;
  const auto rigid = align_points(rest_m_, rough_m);
  if (!rigid) return rough_m;
  const Points3 placed_m = transform_points(*rigid, rest_m_);
  const Eigen::MatrixX3d offsets_m = rough_m - placed_m;
  return placed_m + factor_.solve(offsets_m);
}

}  // namespace weft::solvers
