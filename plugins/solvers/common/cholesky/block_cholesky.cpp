// SPDX-License-Identifier: Apache-2.0
#include "common/cholesky/block_cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::solvers {
namespace {

constexpr double kMiB = 1024.0 * 1024.0, kMostBytes = 1024.0 * kMiB;

/// For each vertex, the vertices that it is coupled to.
IndexLists coupled_lists(const BlockCholesky::Pairs& pairs, Eigen::Index vertex_count) {
  Edges edges(static_cast<Eigen::Index>(pairs.size()), 2);
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    edges.row(static_cast<Eigen::Index>(p)) << pairs[p][0], pairs[p][1];
  }
  return vertex_neighbours(edges, vertex_count);
}

}  // namespace

void BlockMatrix::set_zero() {
  std::fill(diagonal.begin(), diagonal.end(), Eigen::Matrix3d::Zero());
  std::fill(coupling.begin(), coupling.end(), Eigen::Matrix3d::Zero());
}

double BlockMatrix::mean_diagonal() const {
  double sum = 0.0;
  for (const Eigen::Matrix3d& block : diagonal) sum += block.trace();
  return sum / static_cast<double>(3 * diagonal.size());
}

Panel BlockCholesky::panel(const Front& front) {
  return {panels_.data() + front.panel, stride_for(front.rows())};
}

Panel BlockCholesky::update(const Front& front, std::size_t at) {
  return {updates_.data() + at, stride_for(front.border)};
}

Result<void> BlockCholesky::analyse(const Points3View& rest_m, const Pairs& pairs) {
  const EliminationTree tree = nested_dissection(rest_m, coupled_lists(pairs, rest_m.rows()));
  if (auto placed = place_fronts(tree); !placed) return placed;
  in_parent_.assign(border_rows_.size(), 0);
  for (const Front& front : fronts_) {
    if (front.parent < 0) continue;
    for (std::size_t k = front.places; k < front.places + front.vertices_below(); ++k) {
      const std::size_t row = row_in(fronts_[to_index(front.parent)], border_rows_[k]);
      in_parent_[k] = static_cast<std::uint32_t>(row);
    }
  }
  place_blocks(tree, pairs);
  values_.resize(3 * place_.size());
  gathered_.resize(3 * place_.size());
  return {};
}

Result<void> BlockCholesky::place_fronts(const EliminationTree& tree) {
  fronts_.assign(tree.nodes.size(), {});
  border_rows_.clear();
  std::size_t panels = 0, updates = 0, most_updates = 0, inverses = 0, most_scratch = 0;
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    const EliminationNode& node = tree.nodes[f];
    Front& front = fronts_[f];
    front.first = 3 * to_index(node.first);
    front.own = 3 * to_index(node.count);
    front.border = 3 * node.border.size();
    front.panel = panels;
    panels += panel_size(front.rows(), front.own);
    front.places = border_rows_.size();
    for (const std::int32_t p : node.border) {
      border_rows_.push_back(3 * static_cast<std::uint32_t>(p));
    }
    // Its own update is made behind those of its children, and then takes their place.
    front.update = front.kept = updates;
    for (std::int32_t child = front.last_child; child >= 0;) {
      front.kept = std::min(front.kept, fronts_[to_index(child)].kept);
      child = fronts_[to_index(child)].previous_sibling;
    }
    const std::size_t size = panel_size(front.border, front.border);
    most_updates = std::max(most_updates, updates + size);
    updates = front.kept + size;
    most_scratch = std::max(most_scratch, panel_size(front.rows(), front.rows()));
    front.parent = node.parent;
    if (node.parent < 0) continue;
    front.previous_sibling =
        std::exchange(fronts_[to_index(node.parent)].last_child, static_cast<std::int32_t>(f));
  }
  for (std::size_t f = fronts_.size(); f-- > 0;) {
    Front& front = fronts_[f];
    if (front.parent >= 0) {
      const Front& parent = fronts_[to_index(front.parent)];
      front.inverse = parent.inverse + panel_size(parent.rows(), parent.rows());
    }
    inverses = std::max(inverses, front.inverse + panel_size(front.rows(), front.rows()));
  }
  const double bytes =
      8.0 * static_cast<double>(panels + most_updates + inverses + 4 * most_scratch);
  if (bytes > kMostBytes) {
    return Error{Errc::unsupported,
                 "the factor for " + std::to_string(tree.place.size()) + " vertices needs " +
                     std::to_string(std::llround(bytes / kMiB)) + " MiB, more than " +
                     std::to_string(std::llround(kMostBytes / kMiB)) +
                     ": give a template with fewer vertices"};
  }
  panels_.resize(panels);
  updates_.resize(most_updates);
  inverses_.resize(inverses);
  for (std::vector<double>& each : scratch_) each.resize(most_scratch);
  return {};
}

/// The first row in a front of a vertex that is given by its first row in the matrix.
std::size_t BlockCholesky::row_in(const Front& front, std::size_t row) const {
  if (row < front.first + front.own) return row - front.first;
  const auto begin = border_rows_.begin() + static_cast<std::ptrdiff_t>(front.places);
  const auto end = begin + static_cast<std::ptrdiff_t>(front.vertices_below());
  return front.own + 3 * to_index(std::lower_bound(begin, end, row) - begin);
}

void BlockCholesky::place_blocks(const EliminationTree& tree, const Pairs& pairs) {
  std::vector<std::size_t> front_of(tree.place.size());  // front of each place
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    const auto first = front_of.begin() + static_cast<std::ptrdiff_t>(fronts_[f].first / 3);
    std::fill_n(first, fronts_[f].own / 3, f);
  }
  const auto target = [&](std::size_t row, std::size_t column, bool transposed) {
    const Front& front = fronts_[front_of[column / 3]];
    const std::size_t stride = stride_for(front.rows());
    return Target{front.panel + row_in(front, row) + (column - front.first) * stride, stride,
                  transposed};
  };
  place_.clear();
  diagonal_.clear();
  coupling_.clear();
  for (const std::int32_t p : tree.place) {
    place_.push_back(3 * to_index(p));
    diagonal_.push_back(target(place_.back(), place_.back(), false));
  }
  vertex_.resize(place_.size());
  for (std::size_t v = 0; v < place_.size(); ++v) {
    vertex_[place_[v] / 3] = static_cast<std::int32_t>(v);
  }
  for (const auto& [i, j] : pairs) {
    const std::size_t at_i = place_[to_index(i)], at_j = place_[to_index(j)];
    coupling_.push_back(at_i > at_j ? target(at_i, at_j, false) : target(at_j, at_i, true));
  }
}

void BlockCholesky::load(const BlockMatrix& matrix, double damping) {
  std::fill(panels_.begin(), panels_.end(), 0.0);
  const auto put = [&](const Eigen::Matrix3d& block, const Target& target) {
    double* const place = panels_.data() + target.place;
    for (Eigen::Index c = 0; c < 3; ++c) {
      for (Eigen::Index r = 0; r < 3; ++r) {
        place[to_index(c) * target.stride + to_index(r)] =
            target.transposed ? block(c, r) : block(r, c);
      }
    }
  };
  for (std::size_t v = 0; v < diagonal_.size(); ++v) {
    put(matrix.diagonal[v] + damping * Eigen::Matrix3d::Identity(), diagonal_[v]);
  }
  for (std::size_t p = 0; p < coupling_.size(); ++p) put(matrix.coupling[p], coupling_[p]);
}

bool BlockCholesky::factorise(const BlockMatrix& matrix, double damping) {
  load(matrix, damping);
  for (const Front& front : fronts_) {
    worked(static_cast<std::int64_t>(front.own * front.rows() * front.rows() / 64));
    std::fill_n(updates_.data() + front.update, panel_size(front.border, front.border), 0.0);
    for (std::int32_t child = front.last_child; child >= 0;) {
      take_update(fronts_[to_index(child)], front);
      child = fronts_[to_index(child)].previous_sibling;
    }
    if (!factorise_columns(panel(front), front.rows(), front.own)) return false;
    make_update(front);
  }
  return true;
}

/// Adds the lower half of a child's update to the front of its parent.
void BlockCholesky::take_update(const Front& child, const Front& parent) {
  const Panel from = update(child, child.kept);
  const Panel own = panel(parent), beyond = update(parent, parent.update);
  const std::uint32_t* const rows = in_parent_.data() + child.places;
  const std::size_t count = child.vertices_below();
  for (std::size_t c = 0; c < count; ++c) {
    const bool is_own = rows[c] < parent.own;
    const std::size_t before = is_own ? 0 : parent.own;
    for (std::size_t k = 0; k < 3; ++k) {
      const double* const column = &from(0, 3 * c + k);
      double* const to = &(is_own ? own : beyond)(0, rows[c] - before + k);
      for (std::size_t r = c; r < count; ++r) {
        for (std::size_t j = 0; j < 3; ++j) to[rows[r] - before + j] += column[3 * r + j];
      }
    }
  }
}

/// Subtracts what the own columns of a front explain, and moves it to where it waits.
void BlockCholesky::make_update(const Front& front) {
  const Panel below = panel(front).from(front.own, 0), made = update(front, front.update);
  for (std::size_t c = 0; c < front.border; c += kTileColumns) {
    subtract_product(made.from(c, c), below.from(c, 0), below.from(c, 0), front.border - c,
                     front.own);
  }
  if (front.kept == front.update) return;
  std::memmove(updates_.data() + front.kept, made.data,
               sizeof(double) * panel_size(front.border, front.border));
}

}  // namespace weft::solvers
