// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <vector>
#include <weft/geometry/mesh_bending.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/types.hpp>

namespace weft::solvers {

/// Takes creases out of shapes.
class BendSmoother {
 public:
  /// `smoothing` is in squared mean edge lengths; 0: shapes stay as they are.
  void build(const Points3View& rest_m, const MeshTopology& topology,
             const std::vector<BendingHinge>& hinges, double smoothing);

  /// The shape [V,3] nearest to `rough_m` that bends less. It is the minimum of
  ///     |X - rough|^2 + smoothing s^2 (bending energy of X - X_rest),
  /// where s is the mean edge length and X_rest the rest mesh aligned rigidly with `rough`.
  Points3 smoothed(const Points3View& rough_m) const;

 private:
  bool smooths_ = false;
  Points3 rest_m_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace weft::solvers
