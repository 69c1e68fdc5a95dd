// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>
#include <weft/geometry/types.hpp>

namespace weft::pizarro {

/// Three of some neighbours.
using Triple = std::array<int, 3>;

/// Some of the triples of 0 to count - 1, evenly spread over all of them; all where these are
/// fewer.
std::vector<Triple> spread_triples(int count, int wanted);

/// An affine map that at least half of some matches agree with.
struct RobustAffine {
  Eigen::RowVector2d from_px, to_px;  ///< to = to_px + (p - from_px) slope
  Eigen::Matrix2d slope;
  double sigma_px = 0.0;  ///< standard deviation of the matches that agree

  Eigen::RowVector2d operator()(const Eigen::RowVector2d& p) const {
    return to_px + (p - from_px) * slope;
  }
};

/// Least median of squares (Rousseeuw 1984) over maps through three matches: p to q [n,2]. Nothing
/// where all triples are on a line.
std::optional<RobustAffine> least_median_affine(const Points2& p, const Points2& q,
                                                std::span<const Triple> triples);

}  // namespace weft::pizarro
