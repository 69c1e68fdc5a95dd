// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

#include "common/cholesky/dense_kernels.hpp"
#include "common/cholesky/elimination_tree.hpp"

namespace weft::solvers {

/// A symmetric matrix of 3 x 3 blocks: one for each vertex, and one for each pair (i, j) of
/// vertices that are coupled, in its rows those of i.
struct BlockMatrix {
  std::vector<Eigen::Matrix3d> diagonal;  ///< [V]
  std::vector<Eigen::Matrix3d> coupling;  ///< [C]

  void set_zero();
  double mean_diagonal() const;
};

/// The Cholesky factor of a BlockMatrix, by fronts (Duff and Reid, ACM TOMS 9, 1983). Each node of
/// the elimination tree is a dense panel of the node's columns, and passes an update to its parent.
/// Structure and memory are set up once for a mesh; no other call allocates.
class BlockCholesky {
 public:
  using Pairs = std::vector<std::array<std::int32_t, 2>>;

  /// For matrices whose couplings are those of `pairs`. Fails where the factor needs more than 1
  /// GiB.
  Result<void> analyse(const Points3View& rest_m, const Pairs& pairs);

  /// The factor of matrix + damping I; false where that is not positive definite.
  bool factorise(const BlockMatrix& matrix, double damping);

  /// Replaces the right-hand side [V,3] by the solution.
  void solve(Points3& values);

  /// The diagonal blocks of the inverse [V] (Erisman and Tinney, CACM 18, 1975).
  void inverse_blocks(std::vector<Eigen::Matrix3d>& blocks);

  /// Numbers in the factor.
  std::size_t size() const { return panels_.size(); }

 private:
  /// A node of the tree, and where its numbers are.
  struct Front {
    std::size_t first = 0;    ///< row of the whole matrix
    std::size_t own = 0;      ///< columns
    std::size_t border = 0;   ///< rows below them
    std::size_t panel = 0;    ///< in panels_: [own + border, own]
    std::size_t update = 0;   ///< in updates_: [border, border] where it is made ...
    std::size_t kept = 0;     ///< ... and where it waits for the parent
    std::size_t places = 0;   ///< number of places of its border, in border_rows_ and in_parent_
    std::size_t inverse = 0;  ///< in inverses_: [own + border, own + border]
    std::int32_t parent = -1, last_child = -1, previous_sibling = -1;

    std::size_t rows() const { return own + border; }
    std::size_t vertices_below() const { return border / 3; }
  };
  /// Where a block of the matrix goes.
  struct Target {
    std::size_t place;  ///< in panels_
    std::size_t stride;
    bool transposed;
  };

  Result<void> place_fronts(const EliminationTree& tree);
  std::size_t row_in(const Front& front, std::size_t row) const;
  void place_blocks(const EliminationTree& tree, const Pairs& pairs);
  void load(const BlockMatrix& matrix, double damping);
  void take_update(const Front& child, const Front& parent);
  void make_update(const Front& front);
  void forward(const Front& front);
  void backward(const Front& front);
  void gather_border(const Front& front, const Panel& border) const;
  void divide_border(const Front& front, const Panel& divided);
  void invert_own(const Front& front, const Panel& inverse);
  Panel invert(const Front& front);

  Panel panel(const Front& front);
  Panel update(const Front& front, std::size_t at);

  std::vector<Front> fronts_;
  std::vector<std::size_t> place_;          ///< [V] first row of a vertex
  std::vector<std::int32_t> vertex_;        ///< [V] the vertex whose rows they are
  std::vector<std::uint32_t> border_rows_;  ///< first row of each vertex of a border
  std::vector<std::uint32_t> in_parent_;    ///< and its first row in the parent's front
  std::vector<Target> diagonal_, coupling_;
  std::vector<double> panels_, updates_, inverses_;
  std::array<std::vector<double>, 4> scratch_;
  std::vector<double> values_, gathered_;  ///< [3V]
};

/// Numbers that a panel takes with what products round up to.
inline std::size_t stride_for(std::size_t rows) {
  return rounded_up(rows + kTileRows - 1, kTileRows);
}
inline std::size_t panel_size(std::size_t rows, std::size_t columns) {
  return stride_for(rows) * rounded_up(columns, kTileColumns);
}

}  // namespace weft::solvers
