// SPDX-License-Identifier: Apache-2.0
#include "common/duplicates.hpp"

#include <weft/core/index.hpp>

#include "common/point_grid.hpp"

namespace weft::matchers {

std::vector<char> distinct(const std::vector<PointPair>& pairs, const std::vector<int>& best_first,
                           double template_radius_px, double image_radius_px) {
  const auto at = [&](int i) -> const PointPair& { return pairs[to_index(i)]; };
  PointGrid template_points;
  template_points.load(static_cast<int>(pairs.size()), template_radius_px,
                       [&](int i) { return at(i).template_px; });
  std::vector<char> keep(pairs.size(), 0);
  for (const int i : best_first) {
    bool merged = false;
    template_points.for_each_within(at(i).template_px, template_radius_px, [&](int j) {
      merged = merged || (keep[to_index(j)] != 0 &&
                          (at(j).image_px - at(i).image_px).norm() <= image_radius_px);
    });
    keep[to_index(i)] = merged ? 0 : 1;
  }
  return keep;
}

}  // namespace weft::matchers
