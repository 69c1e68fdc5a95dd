// SPDX-License-Identifier: Apache-2.0
#include "least_bending.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <weft/core/index.hpp>
#include <weft/geometry/rigid_alignment.hpp>

namespace weft::solvers {
namespace {

constexpr double kRidge = 1e-6;

/// The held vertices alone.
Points3 chosen_rows(const Points3View& all, const std::vector<std::uint8_t>& fixed,
                    Eigen::Index count) {
  Points3 chosen(count, 3);
  Eigen::Index next = 0;
  for (Eigen::Index v = 0; v < all.rows(); ++v) {
    if (fixed[to_index(v)] != 0) chosen.row(next++) = all.row(v);
  }
  return chosen;
}

/// The moves of the free vertices, numbered by `unknown`, to the least bending, when the others
/// have been moved by `moved` [V,3].
Points3 free_moves(const std::vector<BendingHinge>& hinges, const std::vector<int>& unknown,
                   Eigen::Index free_count, double ridge, const Points3& moved) {
  std::vector<Eigen::Triplet<double>> entries;
  Points3 right = Points3::Zero(free_count, 3);
  for (int i = 0; i < free_count; ++i) entries.emplace_back(i, i, ridge);
  for (const BendingHinge& hinge : hinges) {
    for (std::size_t r = 0; r < 4; ++r) {
      const int row = unknown[to_index(hinge.vertex[r])];
      if (row < 0) continue;
      for (std::size_t c = 0; c < 4; ++c) {
        const double value = hinge.weight * hinge.coefficient_per_m[r] * hinge.coefficient_per_m[c];
        const int column = unknown[to_index(hinge.vertex[c])];
        if (column < 0) right.row(row) -= value * moved.row(hinge.vertex[c]);
        if (column >= 0 && column <= row) entries.emplace_back(row, column, value);
      }
    }
  }
  Eigen::SparseMatrix<double> normal(free_count, free_count);
  normal.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(normal);
  return factor.solve(right);
}

}  // namespace

Result<Points3> fill_with_least_bending(const Points3View& rest_m,
                                        const std::vector<BendingHinge>& hinges, double mean_edge_m,
                                        const std::vector<std::uint8_t>& fixed,
                                        const Points3View& vertices_m) {
  std::vector<int> unknown(fixed.size(), -1);
  int free_count = 0;
  for (std::size_t v = 0; v < fixed.size(); ++v) {
    if (fixed[v] == 0) unknown[v] = free_count++;
  }
  Points3 filled = vertices_m;
  if (free_count == 0) return filled;
  const Eigen::Index fixed_count = vertices_m.rows() - free_count;
  const auto aligned = align_points(chosen_rows(rest_m, fixed, fixed_count),
                                    chosen_rows(vertices_m, fixed, fixed_count));
  if (!aligned) return no_result("the visible part does not determine the rest of the surface");
  const Points3 rigid_m = transform_points(*aligned, rest_m);
  const Points3 moved = vertices_m - rigid_m;
  const Points3 moves =
      free_moves(hinges, unknown, free_count, kRidge / (mean_edge_m * mean_edge_m), moved);
  for (Eigen::Index v = 0; v < filled.rows(); ++v) {
    const int number = unknown[to_index(v)];
    if (number >= 0) filled.row(v) = rigid_m.row(v) + moves.row(number);
  }
  return filled;
}

}  // namespace weft::solvers
