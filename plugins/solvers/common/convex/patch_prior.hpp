// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>
#include <weft/geometry/types.hpp>

#include "common/cholesky/couplings.hpp"

namespace weft::solvers {

/// The norm |L X| of a matrix L that acts alike on the three coordinates of the vertices, in
/// patches that overlap. Its square is the sum over patches p of |B_p X_p|^2.
class PatchPrior {
 public:
  static constexpr Eigen::Index kMostVertices = 25;  ///< most vertices of a patch

  /// B [k,n] 1/m of patches with n vertices, n and k at most kMostVertices; its number.
  std::size_t add_rows(Eigen::MatrixXd rows_per_m);

  /// A patch of these vertices [n], all different, with the rows of that number.
  void add_patch(std::vector<std::int32_t> vertices, std::size_t rows);

  bool empty() const { return patches_.empty(); }
  std::size_t patch_count() const { return patches_.size(); }
  std::size_t model_count() const { return rows_.size(); }  ///< [] different B

  /// Rows of L, for one coordinate.
  std::size_t row_count() const { return row_count_; }

  /// Requests the couplings of all vertices that share a patch.
  void couple(Couplings& couplings);

  /// |L X| of vertices [V,3] m.
  double norm(const Points3& vertices_m) const;

  /// L^T L X into `gathered` [V,3] 1/m; |L X|.
  double gather(const Points3& vertices_m, Points3& gathered) const;

  /// Numbers that one pass of the rows multiplies.
  std::size_t work() const { return work_; }

  /// L^T L of one coordinate, in 1/m^2: for each vertex [V] and for each coupling, by its number.
  const std::vector<double>& diagonal() const { return diagonal_; }
  const std::vector<double>& coupling() const { return coupling_; }

 private:
  struct Patch {
    std::vector<std::int32_t> vertices;
    std::size_t rows;
  };
  using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::ColMajor, kMostVertices, 3>;

  Coefficients coefficients(const Patch& patch, const Points3& vertices_m) const;

  std::vector<Eigen::MatrixXd> rows_;
  std::vector<Patch> patches_;
  std::size_t row_count_ = 0, work_ = 0;
  std::vector<double> diagonal_, coupling_;
};

}  // namespace weft::solvers
