// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCholesky>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace weft {

/// Deviations of a set-up from its description, see SelfCalibration.
inline constexpr int kParts = 8;
using PartVector = Eigen::Matrix<double, kParts, 1>;
using PartMatrix = Eigen::Matrix<double, kParts, kParts>;

/// Strains of the surface that rival the deviation, see CameraEvidence.
inline constexpr int kStrains = 2;
using StrainVector = Eigen::Matrix<double, kStrains, 1>;
using StrainMatrix = Eigen::Matrix<double, kStrains, kStrains>;
using PartsByStrains = Eigen::Matrix<double, kParts, kStrains>;

/// The normal equations of the vertices of a mesh (3 V unknowns) and of a deviation. Each step adds
/// the same blocks in the same order: once the first has been solved, nothing is allocated.
class NormalEquations {
 public:
  using Mixed = Eigen::Matrix<double, Eigen::Dynamic, kParts>;

  /// All of them zero, but for `floor` on the diagonal of the vertices.
  void begin(Eigen::Index vertices, double floor);

  /// A block of rows 3 i and columns 3 j of the vertices' part, which is symmetric: of two that
  /// mirror each other the one with i >= j counts.
  void add_block(std::int32_t i, std::int32_t j, const Eigen::Matrix3d& block);

  /// Finds `by_parts` and `alone`; false where the equations cannot be solved.
  bool solve();

  Mixed mixed;                      ///< [3V,8]
  Eigen::VectorXd vertex_gradient;  ///< [3V]
  PartMatrix parts;
  PartVector part_gradient;
  Eigen::Matrix<double, Eigen::Dynamic, kStrains> strain_mixed;  ///< [3V,2]
  PartsByStrains parts_by_strains;
  StrainMatrix strains;
  StrainVector strain_gradient;

  /// Inverse of the vertices' part, as solve() factorised it, times `strain_mixed`.
  Eigen::Matrix<double, Eigen::Dynamic, kStrains> by_strains() const;

  Mixed by_parts;         ///< [3V,8] inverse of the vertices' part times `mixed`
  Eigen::VectorXd alone;  ///< [3V] the same times `vertex_gradient`

 private:
  struct Added {
    Eigen::Index row, column;  ///< [] position in the matrix
    double value;              ///< unit of the matrix entry
  };
  /// Factorises what is in its order already.
  class Factor : public Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Upper,
                                              Eigen::NaturalOrdering<int>> {
   public:
    void factorize_in_order(const Eigen::SparseMatrix<double>& matrix) {
      this->template factorize_preordered<true>(matrix);
    }
  };

  void add(Eigen::Index row, Eigen::Index column, double value);
  void lay_out();

  Eigen::Index unknowns_ = 0;
  std::vector<Added> first_;         ///< blocks of the first step
  std::vector<std::size_t> places_;  ///< position of each addition among the values of the matrix
  std::size_t added_ = 0;            ///< in this step
  /// From the order of the vertices to one in which few zeros fill up.
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order_, back_;
  Eigen::SparseMatrix<double> matrix_;  ///< upper triangle, in that order
  Mixed ordered_mixed_, ordered_by_parts_;
  Eigen::VectorXd ordered_gradient_, ordered_alone_;
  std::unique_ptr<Factor> factor_ = std::make_unique<Factor>();  // it cannot be moved
};

}  // namespace weft
