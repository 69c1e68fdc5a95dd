// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>
#include <weft/core/rng.hpp>

#include "matches.hpp"

namespace weft::aem {

/// An affine map from the template to the image: q = slope p + offset.
struct Affine {
  Eigen::Matrix2d slope = Eigen::Matrix2d::Identity();
  Eigen::Vector2d offset_px = Eigen::Vector2d::Zero();

  Eigen::Vector2d operator()(const Eigen::Vector2d& point_px) const {
    return slope * point_px + offset_px;
  }
  double scale() const { return std::sqrt(slope.determinant()); }
};

/// A map that a part of the matches follow roughly.
struct Seed {
  Affine map;
  double threshold_px = 0.0;  ///< how roughly
  double share = 0.0;         ///< [] of the matches, each by how well it fits
  double score = 0.0;         ///< larger for a part that chance would hardly bring together
};

struct Seeds {
  std::vector<Seed> best;  ///< best first, of different places
  int draws = 0;
};

/// Affine maps through three random ones of the matches in `rows` and, where they are oriented,
/// similarities through one. The threshold is a part of the template's diagonal as the map shows
/// it: a map that shrinks the template to a cluster of mismatches has no advantage from it.
Seeds draw_seeds(const Matches& matches, const std::vector<Eigen::Index>& rows, int most_draws,
                 Rng& rng);

}  // namespace weft::aem
