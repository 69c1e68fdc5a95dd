// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>
#include <weft/geometry/types.hpp>
#include <weft/sdk/filter.hpp>

namespace weft::filters {

/// The matches that a filter judges, without those that previous filters rejected. Their
/// coordinates determine their order, so that neither sums nor random samples depend on the order
/// of the matches. Matches from one place to one place are judged as one.
struct Candidates {
  /// A match at both places of a candidate.
  struct Copy {
    std::int64_t match;
    std::size_t candidate;
  };

  std::vector<std::int64_t> matches;  ///< [n] of copies the one with the least ratio
  std::vector<Copy> copies;           ///< the others
  Points2 template_px, image_px;      ///< [n,2]

  std::size_t count() const { return matches.size(); }
};

/// invalid_data names a candidate with a coordinate that is not finite.
Result<Candidates> candidates_of(const Correspondences& correspondences);

/// A mask over all matches: candidate k is kept where keep[k], with score[k] in [0,1]; the others
/// are rejected with the score 0. Counts candidates and what is kept.
InlierMask mask_of(const Correspondences& correspondences, const Candidates& candidates,
                   std::span<const std::uint8_t> keep, std::span<const double> score);

/// Width and height of the texture and of the image.
struct PictureSizes {
  Eigen::RowVector2d template_px, image_px;
};

/// invalid_data where template or camera is absent.
Result<PictureSizes> sizes_of(const FilterInput& in);

/// Translates to zero mean and scales to a mean norm of sqrt(2).
struct Normaliser {
  Eigen::RowVector2d mean_px = Eigen::RowVector2d::Zero();
  double per_px = 1.0;  ///< 0 where all points coincide

  explicit Normaliser(const Points2& points_px);
  Points2 operator()(const Points2& points_px) const {
    return per_px * (points_px.rowwise() - mean_px);
  }
};

}  // namespace weft::filters
