// SPDX-License-Identifier: Apache-2.0
#include "cell_support.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <weft/core/index.hpp>

namespace weft::gms {
namespace {

constexpr int kNowhere = -1;
constexpr std::size_t kAround = 8;
/// The cells around one, an eighth of a turn from each to the next.
constexpr std::array<std::pair<int, int>, kAround> kRing{
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

/// A square grid of cells over an image.
struct Grid {
  int cells;
  double shift_u = 0.0, shift_v = 0.0;  ///< in cells

  int cell_of(double u, double v) const {
    const int column = static_cast<int>(std::floor(u * cells + shift_u));
    const int row = static_cast<int>(std::floor(v * cells + shift_v));
    const bool inside = column >= 0 && column < cells && row >= 0 && row < cells;
    return inside ? row * cells + column : kNowhere;
  }

  int beside(int cell, std::pair<int, int> step) const {
    const int column = cell % cells + step.first, row = cell / cells + step.second;
    const bool inside = column >= 0 && column < cells && row >= 0 && row < cells;
    return inside ? row * cells + column : kNowhere;
  }
};

/// How many matches go from each cell of the template to each of the image.
class Flows {
 public:
  Flows(const std::vector<int>& from, const std::vector<int>& to, int cells) {
    std::vector<std::pair<int, int>> moves;
    for (std::size_t i = 0; i < from.size(); ++i) {
      if (from[i] != kNowhere && to[i] != kNowhere) moves.emplace_back(from[i], to[i]);
    }
    std::sort(moves.begin(), moves.end());
    first_.assign(to_index(cells) + 1, 0);
    matches_.assign(to_index(cells), 0);
    for (std::size_t i = 0; i < moves.size(); ++i) {
      const auto cell = to_index(moves[i].first);
      ++matches_[cell];
      if (i > 0 && moves[i] == moves[i - 1]) {
        ++counts_.back();
        continue;
      }
      to_.push_back(moves[i].second);
      counts_.push_back(1);
      ++first_[cell + 1];
    }
    for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  }

  int matches_in(int a) const { return a == kNowhere ? 0 : matches_[to_index(a)]; }

  int between(int a, int b) const {
    if (a == kNowhere || b == kNowhere) return 0;
    for (std::size_t f = begin_of(a); f < end_of(a); ++f) {
      if (to_[f] == b) return counts_[f];
    }
    return 0;
  }

  /// Where most matches of a cell go, the first of equals; nowhere from an empty cell.
  int main_target(int a) const {
    int best = kNowhere, most = 0;
    for (std::size_t f = begin_of(a); f < end_of(a); ++f) {
      if (counts_[f] <= most) continue;
      most = counts_[f];
      best = to_[f];
    }
    return best;
  }

 private:
  std::size_t begin_of(int a) const { return first_[to_index(a)]; }
  std::size_t end_of(int a) const { return first_[to_index(a) + 1]; }

  std::vector<std::size_t> first_;  // first target of each cell
  std::vector<int> to_, counts_;    // targets, ascending within a cell
  std::vector<int> matches_;        // in each cell
};

}  // namespace

std::vector<double> support_of(const Points2& in_template, const Points2& in_image,
                               const Layout& layout) {
  const Grid grid{layout.cells, layout.shifted_u ? 0.5 : 0.0, layout.shifted_v ? 0.5 : 0.0};
  const Grid image_grid{layout.image_cells};
  std::vector<int> from, to;
  for (Eigen::Index i = 0; i < in_template.rows(); ++i) {
    from.push_back(grid.cell_of(in_template(i, 0), in_template(i, 1)));
    to.push_back(image_grid.cell_of(in_image(i, 0), in_image(i, 1)));
  }
  const Flows flows(from, to, layout.cells * layout.cells);
  std::vector<int> target(to_index(layout.cells * layout.cells), kNowhere);
  std::vector<double> support(target.size(), 0.0);
  for (int a = 0; a < layout.cells * layout.cells; ++a) {
    const int b = flows.main_target(a);
    if (b == kNowhere) continue;
    int supporting = flows.between(a, b), present = flows.matches_in(a), cells = 1;
    for (std::size_t k = 0; k < kAround; ++k) {
      const int beside_a = grid.beside(a, kRing[k]);
      const int beside_b = image_grid.beside(b, kRing[(k + to_index(layout.turn)) % kAround]);
      if (beside_a == kNowhere || beside_b == kNowhere) continue;
      ++cells;
      present += flows.matches_in(beside_a);
      supporting += flows.between(beside_a, beside_b);
    }
    target[to_index(a)] = b;
    support[to_index(a)] = supporting / std::sqrt(static_cast<double>(present) / cells);
  }
  std::vector<double> of_match(from.size(), 0.0);
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (from[i] == kNowhere || to[i] == kNowhere) continue;
    const auto a = to_index(from[i]);
    if (target[a] == to[i]) of_match[i] = support[a];
  }
  return of_match;
}

}  // namespace weft::gms
