// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/geometry/types.hpp>

namespace weft::pizarro {

inline constexpr int kFewestLocal = 12;  ///< matches below which one affine map judges them all

struct Settings {
  double theta = 0.3;   ///< largest residual of a match that agrees
  int neighbours = 10;  ///< nearest matches in the template that predict one
  int triples = 12;     ///< maps tried for each match
  int rounds = 10;      ///< rounds of removal
};

/// Which matches their neighbours predict.
struct Verdict {
  std::vector<std::uint8_t> keep;  ///< [n]
  /// [n] Distance from where the neighbours predict a match, in the spread of these in the image;
  /// NaN where they predict nothing.
  std::vector<double> residual;
  int rounds = 0;
};

/// Rejection by local smoothness (after Pizarro and Bartoli 2012, Section 3), places in px. Rounds
/// remove the matches that contradict most neighbourhoods, their own and those that contain them,
/// at most a fifth each. Then the nearest remaining matches decide on all matches. Needs 4 matches.
Verdict locally_smooth(const Points2& in_template, const Points2& in_image,
                       const Settings& settings);

}  // namespace weft::pizarro
