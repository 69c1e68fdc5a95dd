// SPDX-License-Identifier: Apache-2.0
#include "flow_grid.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/stop_check.hpp>

#include "common/workers/sharing.hpp"

namespace weft::dense_flow {
namespace {

using view::Alignment;
using view::at_level;
using view::kLevels;
using view::Patch;
using view::Picture;
using view::ViewLevel;

constexpr float kReach_px = 5.0F;  // px of the level, from the place where a search begins
constexpr float kAlike = 0.5F;     // correlation at coarse levels of a patch that leads finer ones
constexpr int kCoarseSpacing_px = 8;  // at most, where displacements are only led on
constexpr int kFewestNeighbours = 3;

}  // namespace

void FlowGrid::find(const view::PredictedView& view, const view::Pyramid& image,
                    const Eigen::Vector2d& start_px, const FlowOptions& options, Workers& workers,
                    int threads) {
  options_ = options;
  patches_.resize(to_index(std::max(threads, 1)));
  for (int level = kLevels - 1; level >= view.finest(); --level) {
    std::swap(grid_, coarser_);
    lay_out(view.level(level), level == view.finest()
                                   ? options_.spacing_px
                                   : std::min(options_.spacing_px, kCoarseSpacing_px));
    if (level == kLevels - 1) {
      const Eigen::Vector2f start = (start_px / static_cast<double>(1 << level)).cast<float>();
      for (Node& node : grid_.nodes) node.by_px = start;
    } else {
      begin_from(coarser_);
    }
    share_out(workers, {grid_.rows, 1, threads}, [&](int worker, int row, int) {
      search_row(view, image, level, row, patches_[to_index(worker)]);
      return true;
    });
    reject_astray();
    if (level > view.finest()) spread();
  }
}

void FlowGrid::lay_out(const ViewLevel& view, int spacing_px) {
  grid_.spacing_px = spacing_px;
  grid_.x0 = view.x0 + spacing_px / 2;
  grid_.y0 = view.y0 + spacing_px / 2;
  const int behind = spacing_px - spacing_px / 2 - 1;
  grid_.columns = (view.grey.width + behind) / spacing_px;
  grid_.rows = (view.grey.height + behind) / spacing_px;
  grid_.nodes.assign(to_index(grid_.columns * grid_.rows), {});
}

/// Bilinear between the nodes of a grid at half the size, whose displacements are all known.
void FlowGrid::begin_from(const Grid& coarser) {
  if (coarser.nodes.empty()) return;
  for (int row = 0; row < grid_.rows; ++row) {
    for (int column = 0; column < grid_.columns; ++column) {
      const Eigen::Vector2i place = grid_.place_px(column, row);
      const auto along = [&](int at, int first, int count) {
        const double position = (at_level(at, 1) - first) / coarser.spacing_px;
        return std::clamp(position, 0.0, static_cast<double>(count - 1));
      };
      const double x = along(place.x(), coarser.x0, coarser.columns);
      const double y = along(place.y(), coarser.y0, coarser.rows);
      const int i = static_cast<int>(x), j = static_cast<int>(y);
      const int right = std::min(i + 1, coarser.columns - 1);
      const int below = std::min(j + 1, coarser.rows - 1);
      const auto s = static_cast<float>(x - i), t = static_cast<float>(y - j);
      const Eigen::Vector2f upper =
          (1.0F - s) * coarser.at(i, j).by_px + s * coarser.at(right, j).by_px;
      const Eigen::Vector2f lower =
          (1.0F - s) * coarser.at(i, below).by_px + s * coarser.at(right, below).by_px;
      grid_.at(column, row).by_px = 2.0F * ((1.0F - t) * upper + t * lower);
    }
  }
}

void FlowGrid::search_row(const view::PredictedView& view, const view::Pyramid& image, int level,
                          int row, Patch& patch) {
  worked(100 * grid_.columns);
  for (int column = 0; column < grid_.columns; ++column) {
    search(view, image, level, column, row, patch);
  }
}

void FlowGrid::search(const view::PredictedView& view, const view::Pyramid& image, int level,
                      int column, int row, Patch& patch) {
  Node& node = grid_.at(column, row);
  const Eigen::Vector2i place = grid_.place_px(column, row);
  const Patch::Fit fit =
      patch.take(view.level(level), place.x() - Patch::kSide / 2, place.y() - Patch::kSide / 2);
  if (fit != Patch::Fit::usable) {
    node.fate = fit == Patch::Fit::flat ? Fate::flat : Fate::hidden;
    return;
  }
  const bool is_finest = level == view.finest();
  const Picture& picture = image.level(level);
  if (is_finest) node.correlation_before = patch.correlation_at(picture, 0.0F, 0.0F);
  const Alignment found = patch.find_in(picture, node.by_px.x(), node.by_px.y(), kReach_px);
  if (found.end == Alignment::End::left_image) return;  // hidden
  node.correlation = found.correlation;
  node.fate = Fate::unlike;
  if (found.end != Alignment::End::converged) return;
  if (found.correlation < (is_finest ? static_cast<float>(options_.min_correlation) : kAlike))
    return;
  node.by_px = {found.dx, found.dy};
  node.fate = Fate::found;
  if (!is_finest) return;
  node.covariance_px2 = patch.covariance_px2(found.correlation).cast<float>();
  if (!comes_back(view.level(level), picture, column, row, patch)) node.fate = Fate::one_way;
}

/// True if the found piece of the image is found again at its origin in the view.
bool FlowGrid::comes_back(const ViewLevel& view, const Picture& image, int column, int row,
                          Patch& patch) const {
  const Eigen::Vector2i place = grid_.place_px(column, row);
  const Eigen::Vector2f& by = grid_.at(column, row).by_px;
  const Eigen::Vector2i seen = place + by.array().round().cast<int>().matrix();
  if (patch.take(image, seen.x() - Patch::kSide / 2, seen.y() - Patch::kSide / 2) !=
      Patch::Fit::usable) {
    return false;
  }
  const Eigen::Vector2f expected = -by - Eigen::Vector2i(view.x0, view.y0).cast<float>();
  const Alignment found = patch.find_in(view.grey, expected.x(), expected.y(), kReach_px);
  if (found.end != Alignment::End::converged) return false;
  const Eigen::Vector2f off = Eigen::Vector2f(found.dx, found.dy) - expected;
  return off.norm() <= static_cast<float>(options_.max_round_trip_px);
}

/// Rejects nodes whose motion differs from the median of the found nodes around them.
void FlowGrid::reject_astray() {
  const auto most = static_cast<float>(options_.max_deviation_px);
  astray_.assign(grid_.nodes.size(), 0);
  for (int row = 0; row < grid_.rows; ++row) {
    for (int column = 0; column < grid_.columns; ++column) {
      const Node& node = grid_.at(column, row);
      if (node.fate != Fate::found) continue;
      // The median is off if at least half of the values are.
      int count = 0;
      std::array<int, 2> above{}, below{};
      for (int j = std::max(row - 1, 0); j <= std::min(row + 1, grid_.rows - 1); ++j) {
        for (int i = std::max(column - 1, 0); i <= std::min(column + 1, grid_.columns - 1); ++i) {
          const Node& other = grid_.at(i, j);
          if (other.fate != Fate::found || (i == column && j == row)) continue;
          ++count;
          for (int k = 0; k < 2; ++k) {
            const float off = other.by_px[k] - node.by_px[k];
            above[to_index(k)] += off > most ? 1 : 0;
            below[to_index(k)] += off < -most ? 1 : 0;
          }
        }
      }
      const int middle = count / 2;  // index of the median in ascending order
      const bool is_off =
          std::max(above[0], above[1]) >= count - middle || std::max(below[0], below[1]) > middle;
      astray_[to_index(row * grid_.columns + column)] = count < kFewestNeighbours || is_off ? 1 : 0;
    }
  }
  for (std::size_t i = 0; i < astray_.size(); ++i) {
    if (astray_[i] != 0) grid_.nodes[i].fate = Fate::astray;
  }
}

/// Gives the nodes that were not found the mean of their neighbours, ring by ring.
void FlowGrid::spread() {
  known_.resize(grid_.nodes.size());
  std::size_t unknown = 0;
  for (std::size_t i = 0; i < known_.size(); ++i) {
    known_[i] = grid_.nodes[i].fate == Fate::found ? 1 : 0;
    unknown += known_[i] == 0 ? 1 : 0;
  }
  if (unknown == known_.size()) return;  // all stay where they began
  spread_.resize(known_.size());
  while (unknown > 0) {
    known_next_ = known_;
    for (int row = 0; row < grid_.rows; ++row) {
      for (int column = 0; column < grid_.columns; ++column) {
        const std::size_t at = to_index(row * grid_.columns + column);
        if (known_[at] != 0) continue;
        Eigen::Vector2f sum = Eigen::Vector2f::Zero();
        float count = 0.0F;
        for (int j = std::max(row - 1, 0); j <= std::min(row + 1, grid_.rows - 1); ++j) {
          for (int i = std::max(column - 1, 0); i <= std::min(column + 1, grid_.columns - 1); ++i) {
            if (known_[to_index(j * grid_.columns + i)] == 0) continue;
            sum += grid_.at(i, j).by_px;
            count += 1.0F;
          }
        }
        if (count == 0.0F) continue;
        spread_[at] = sum / count;
        known_next_[at] = 1;
        --unknown;
      }
    }
    for (std::size_t i = 0; i < known_.size(); ++i) {
      if (known_next_[i] != known_[i]) grid_.nodes[i].by_px = spread_[i];
    }
    std::swap(known_, known_next_);
  }
}

const Node* FlowGrid::nearest_found(const Eigen::Vector2d& place_px) const {
  const double x = (place_px.x() - grid_.x0) / grid_.spacing_px;
  const double y = (place_px.y() - grid_.y0) / grid_.spacing_px;
  if (!(x > -1.0 && y > -1.0 && x < grid_.columns && y < grid_.rows)) return nullptr;
  const int column = static_cast<int>(std::lround(x)), row = static_cast<int>(std::lround(y));
  const Node* nearest = nullptr;
  double least = 1e30;
  for (int j = std::max(row - 1, 0); j <= std::min(row + 1, grid_.rows - 1); ++j) {
    for (int i = std::max(column - 1, 0); i <= std::min(column + 1, grid_.columns - 1); ++i) {
      const double distance = std::hypot(x - i, y - j);
      if (grid_.at(i, j).fate != Fate::found || distance >= least) continue;
      least = distance;
      nearest = &grid_.at(i, j);
    }
  }
  return nearest;
}

}  // namespace weft::dense_flow
