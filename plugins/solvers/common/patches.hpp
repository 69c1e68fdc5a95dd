// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>
#include <weft/core/index.hpp>

#include "warp_grid.hpp"

namespace weft::solvers {

/// Which places of a WarpGrid lie beside which, along u and along v.
class GridNeighbours {
 public:
  explicit GridNeighbours(const std::vector<WarpPlace>& places);

  /// Calls `visit` with each of the up to four neighbours of a place.
  template <class Visit>
  void each(std::size_t place, Visit&& visit) const {
    constexpr std::array<std::array<int, 2>, 4> kSteps{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
    for (const auto& [di, dj] : kSteps) {
      const int i = places_[place].i + di, j = places_[place].j + dj;
      if (i < 0 || j < 0 || i >= columns_ || j >= rows_) continue;
      if (at_[cell(i, j)] != kNoVertex) visit(at_[cell(i, j)]);
    }
  }

 private:
  static constexpr std::size_t kNoVertex = static_cast<std::size_t>(-1);

  std::size_t cell(int i, int j) const { return to_index(i) * to_index(rows_) + to_index(j); }

  const std::vector<WarpPlace>& places_;
  int columns_ = 0, rows_ = 0;
  std::vector<std::size_t> at_;  ///< [columns * rows] place or kNobody
};

/// The patches of the grid: connected parts with nothing seen between them. Integration leaves a
/// constant or a sign free in each patch, which is determined for each patch separately. Labels [n]
/// from 0.
std::vector<int> patches_of(const std::vector<WarpPlace>& places);

/// For each place [n] the median of `values` [n] over its patch.
Eigen::VectorXd medians_of_patches(const std::vector<int>& patches, const Eigen::VectorXd& values);
/// The same with the mean.
Eigen::VectorXd means_of_patches(const std::vector<int>& patches, const Eigen::VectorXd& values);

}  // namespace weft::solvers
