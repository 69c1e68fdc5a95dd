// SPDX-License-Identifier: Apache-2.0
#include "common/cholesky/elimination_tree.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::solvers {
namespace {

constexpr std::size_t kLeafVertices = 16;

class Dissection {
 public:
  Dissection(const Points3View& rest_m, const IndexLists& coupled)
      : rest_m_(rest_m), coupled_(coupled), side_(to_index(rest_m.rows()), 0) {
    tree_.place.resize(side_.size());
  }

  EliminationTree run() {
    std::vector<std::int32_t> all(side_.size());
    for (std::size_t v = 0; v < all.size(); ++v) all[v] = static_cast<std::int32_t>(v);
    split(all);
    find_borders();
    return std::move(tree_);
  }

 private:
  using Part = std::span<std::int32_t>;

  /// Adds the nodes of a part; the number of its last one.
  std::int32_t split(Part part) {
    worked(static_cast<std::int64_t>(20 * part.size()));
    if (part.size() <= kLeafVertices) return add_node(part, {});
    const std::size_t half = part.size() / 2;
    const Eigen::Index axis = longest_axis(part);
    std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(half), part.end(),
                     [&](std::int32_t a, std::int32_t b) {
                       const double at_a = rest_m_(a, axis), at_b = rest_m_(b, axis);
                       return at_a < at_b || (at_a == at_b && a < b);
                     });
    const Part low = part.first(half), high = part.subspan(half);
    const std::size_t of_low = move_separator_back(low, high);
    const std::size_t of_high = move_separator_back(high, low);
    const bool from_low = of_low <= of_high;
    const Part first = from_low ? low.first(half - of_low) : low;
    const Part second = from_low ? high : high.first(high.size() - of_high);
    const Part between = from_low ? low.last(of_low) : high.last(of_high);
    if (first.empty() || second.empty()) return add_node(part, {});
    const std::int32_t children[2] = {split(first), split(second)};
    return add_node(between, children);
  }

  Eigen::Index longest_axis(Part part) const {
    Eigen::RowVector3d low = rest_m_.row(part[0]), high = low;
    for (const std::int32_t v : part) {
      low = low.cwiseMin(rest_m_.row(v));
      high = high.cwiseMax(rest_m_.row(v));
    }
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    return axis;
  }

  /// Brings the vertices of a part that are coupled to the other one to its end; how many there
  /// are.
  std::size_t move_separator_back(Part part, Part other) {
    ++mark_;
    for (const std::int32_t v : other) side_[to_index(v)] = mark_;
    const auto end = std::stable_partition(part.begin(), part.end(), [&](std::int32_t v) {
      const auto joined = coupled_[v];
      return std::none_of(joined.begin(), joined.end(),
                          [&](std::int32_t w) { return side_[to_index(w)] == mark_; });
    });
    return to_index(part.end() - end);
  }

  std::int32_t add_node(Part vertices, std::span<const std::int32_t> children) {
    const auto number = static_cast<std::int32_t>(tree_.nodes.size());
    for (const std::int32_t child : children) tree_.nodes[to_index(child)].parent = number;
    EliminationNode node;
    node.first = placed_;
    node.count = static_cast<std::int32_t>(vertices.size());
    std::sort(vertices.begin(), vertices.end());
    for (const std::int32_t v : vertices) {
      tree_.place[to_index(v)] = placed_++;
      at_place_.push_back(v);
    }
    tree_.nodes.push_back(std::move(node));
    return number;
  }

  void find_borders() {
    for (std::size_t n = 0; n < tree_.nodes.size(); ++n) {
      EliminationNode& node = tree_.nodes[n];
      const std::int32_t end = node.first + node.count;
      for (std::int32_t p = node.first; p < end; ++p) {
        for (const std::int32_t w : coupled_[at_place_[to_index(p)]]) {
          if (tree_.place[to_index(w)] >= end) node.border.push_back(tree_.place[to_index(w)]);
        }
      }
      worked(static_cast<std::int64_t>(10 * node.border.size()));
      std::sort(node.border.begin(), node.border.end());
      node.border.erase(std::unique(node.border.begin(), node.border.end()), node.border.end());
      if (node.parent < 0) continue;
      EliminationNode& parent = tree_.nodes[to_index(node.parent)];
      const std::int32_t beyond = parent.first + parent.count;
      std::copy_if(node.border.begin(), node.border.end(), std::back_inserter(parent.border),
                   [&](std::int32_t p) { return p >= beyond; });
    }
  }

  const Points3View& rest_m_;
  const IndexLists& coupled_;
  std::vector<std::int32_t> side_;  ///< [V] the last mark that a vertex was given
  std::int32_t mark_ = 0, placed_ = 0;
  std::vector<std::int32_t> at_place_;
  EliminationTree tree_;
};

}  // namespace

EliminationTree nested_dissection(const Points3View& rest_m, const IndexLists& coupled) {
  return Dissection(rest_m, coupled).run();
}

}  // namespace weft::solvers
