// SPDX-License-Identifier: Apache-2.0
#include "common/pruning.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <weft/core/index.hpp>

#include "common/duplicates.hpp"

namespace weft::matchers {
namespace {

auto quality(const Match& match) {
  return std::tuple(match.distance, match.template_keypoint, match.image_keypoint);
}

std::vector<int> sorted_indices(std::size_t count, const auto& less) {
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), less);
  return order;
}

void keep_flagged(const std::vector<char>& keep, std::vector<Match>& matches) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (keep[i] != 0) matches[kept++] = matches[i];
  }
  matches.resize(kept);
}

}  // namespace

void keep_one_per_image_point(std::vector<Match>& matches) {
  const auto at = [&](int i) -> const Match& { return matches[to_index(i)]; };
  const std::vector<int> order = sorted_indices(matches.size(), [&](int i, int j) {
    const Match &a = at(i), &b = at(j);
    return std::tuple(a.image_px.y(), a.image_px.x(), quality(a)) <
           std::tuple(b.image_px.y(), b.image_px.x(), quality(b));
  });
  std::vector<char> keep(matches.size(), 0);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool first = k == 0 || at(order[k]).image_px != at(order[k - 1]).image_px;
    keep[to_index(order[k])] = first ? 1 : 0;
  }
  keep_flagged(keep, matches);
}

void merge_duplicates(double radius_px, std::vector<Match>& matches) {
  if (radius_px == 0.0) return;
  const std::vector<int> order = sorted_indices(matches.size(), [&](int i, int j) {
    return quality(matches[to_index(i)]) < quality(matches[to_index(j)]);
  });
  std::vector<PointPair> pairs;
  for (const Match& match : matches) pairs.push_back({match.template_px, match.image_px});
  keep_flagged(distinct(pairs, order, radius_px, radius_px), matches);
}

}  // namespace weft::matchers
