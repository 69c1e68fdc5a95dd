// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// One list of indices per vertex, stored consecutively.
struct IndexLists {
  std::vector<std::int32_t> offsets;  ///< [n+1] start of each list in `items`
  std::vector<std::int32_t> items;    ///< [.] indices, ascending within a list

  Eigen::Index size() const { return static_cast<Eigen::Index>(offsets.size()) - 1; }

  std::span<const std::int32_t> operator[](Eigen::Index i) const {
    const auto first = to_index(offsets[to_index(i)]);
    const auto last = to_index(offsets[to_index(i) + 1]);
    return {items.data() + first, last - first};
  }
};

namespace detail {

/// Makes lists from (list, item) pairs, in linear time apart from the lists themselves.
inline IndexLists gather(const std::vector<std::pair<std::int32_t, std::int32_t>>& pairs,
                         Eigen::Index count) {
  IndexLists lists;
  lists.offsets.assign(to_index(count) + 1, 0);
  for (const auto& pair : pairs) ++lists.offsets[to_index(pair.first) + 1];
  for (std::size_t i = 1; i < lists.offsets.size(); ++i) lists.offsets[i] += lists.offsets[i - 1];
  std::vector<std::int32_t> next(lists.offsets.begin(), lists.offsets.end() - 1);
  lists.items.resize(pairs.size());
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    worked_in_loop(static_cast<std::int64_t>(p));
    const auto list = to_index(pairs[p].first);
    lists.items[to_index(next[list]++)] = pairs[p].second;
  }
  for (std::size_t i = 0; i < next.size(); ++i) {
    worked_in_loop(static_cast<std::int64_t>(i), 5);
    std::sort(lists.items.begin() + lists.offsets[i], lists.items.begin() + lists.offsets[i + 1]);
  }
  return lists;
}

}  // namespace detail

/// The faces around each vertex. The indices must be in range.
inline IndexLists vertex_faces(const FacesView& faces, Eigen::Index vertex_count) {
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  pairs.reserve(to_index(3 * faces.rows()));
  for (std::int32_t f = 0; f < faces.rows(); ++f) {
    worked_in_loop(f);
    for (int k = 0; k < 3; ++k) pairs.emplace_back(faces(f, k), f);
  }
  return detail::gather(pairs, vertex_count);
}

/// The neighbours of each vertex along the (unique) edges.
inline IndexLists vertex_neighbours(const EdgesView& edges, Eigen::Index vertex_count) {
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  pairs.reserve(to_index(2 * edges.rows()));
  for (Eigen::Index e = 0; e < edges.rows(); ++e) {
    worked_in_loop(e);
    pairs.emplace_back(edges(e, 0), edges(e, 1));
    pairs.emplace_back(edges(e, 1), edges(e, 0));
  }
  return detail::gather(pairs, vertex_count);
}

}  // namespace weft
