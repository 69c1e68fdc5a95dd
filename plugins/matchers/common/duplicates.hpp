// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace weft::matchers {

/// The two points of a match: finite, in pixels.
struct PointPair {
  Eigen::Vector2d template_px;
  Eigen::Vector2d image_px;
};

/// A flag for each pair: 1 unless a better pair of flag 1 has both points within the radii of this
/// pair, the circles included. `best_first` lists all indices from the best pair to the worst.
std::vector<char> distinct(const std::vector<PointPair>& pairs, const std::vector<int>& best_first,
                           double template_radius_px, double image_radius_px);

}  // namespace weft::matchers
