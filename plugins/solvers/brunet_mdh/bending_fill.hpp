// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <array>
#include <span>
#include <vector>

#include "rest_surface.hpp"

namespace weft::brunet_mdh {

/// Places all vertices when some surface points have been placed: X = X_rigid + Y. X_rigid is the
/// rest mesh aligned rigidly with the placed points. Y moves these points to their places with the
/// least bending
///     sum over hinges h of  weight_h |sum_k coefficient_hk Y_hk|^2  +  1e-6 / s^2 |Y|^2,
/// hinges as in BendingHinge, s the mean edge length. The small second term makes the minimum
/// unique. Vertices among the points are met exactly, points inside faces in the least-squares
/// sense.
class BendingFill {
 public:
  /// Analyses and factorises for these points. The result of place() depends on these alone.
  void prepare(const RestSurface& surface, std::span<const SurfacePoint> points);

  /// All vertices [V,3], m, camera frame, for the points' positions [n,3]. no_result if they do not
  /// determine a rigid placement: fewer than three, or on a line.
  Result<Points3> place(const RestSurface& surface, const Points3& positions_m) const;

 private:
  struct Term {  ///< weight |sum_k c_k Y_k - target|^2
    double weight;
    int count;
    std::array<std::int32_t, 4> vertex;
    std::array<double, 4> coefficient;
    std::int32_t target;  ///< point that it pulls, -1 for none
  };

  void factorise();

  std::vector<SurfacePoint> points_;
  std::vector<std::int32_t> fixed_by_;  ///< [V] point that is this vertex, -1 for none
  std::vector<std::int32_t> unknown_;   ///< [V] number of a free vertex, -1 for a fixed one
  std::vector<Term> terms_;
  double ridge_ = 0.0;
  Eigen::Index free_count_ = 0;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace weft::brunet_mdh
