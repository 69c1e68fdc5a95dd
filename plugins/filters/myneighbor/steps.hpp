// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/geometry/types.hpp>

namespace weft::myneighbor {

/// Step I: which matches have a small mismatch factor.
struct Selection {
  std::vector<std::uint8_t> selected;  ///< [n] 0 or 1
  std::int64_t count = 0;
  double mean_percent = 0.0;
  double threshold_percent = 0.0;
  bool fallback = false;  ///< too few were below the threshold: the smallest were taken
};

/// Selects factors below `scale` times their mean; all when they are equal; the smallest
/// max(8, 20 %) (and those equal to the largest of these) when fewer than `least` are below.
void select_small(const std::vector<double>& factors_percent, double scale, std::int64_t least,
                  Selection& selection);

/// Step II: which of the selected matches are near the median distance.
struct Trim {
  std::vector<std::uint8_t> kept;  ///< [n] 0 or 1
  std::int64_t count = 0;
  double median_px = 0.0;
  double mad_px = 0.0;  ///< 1.4826 * median |d - median|, at least 0.01 px
};

/// Keeps a selected match when |d - median| < 2.5 MAD, on both sides.
void trim_by_distance(const std::vector<double>& distance_px,
                      const std::vector<std::uint8_t>& selected, Trim& trim);

/// Mean distance over all pairs of points [n,2]; 0 for fewer than two.
double mean_pair_distance(const Points2View& points);

/// Share of faces whose signed area has not the sign of the majority, 0 to 1.
double folded_share(const Points2View& vertices, const FacesView& faces);

}  // namespace weft::myneighbor
