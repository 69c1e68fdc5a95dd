// SPDX-License-Identifier: Apache-2.0
#include "common/nearest.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::filters {
namespace {

constexpr double kInCell = 3.0;   // points on average: 9 cells mostly hold the 8 nearest
constexpr double kTooFull = 1.5;  // times as many

/// A squared distance and an index in one positive number: the nearer first, then the smaller
/// index. The bits of positive numbers have their order.
using Key = double;
constexpr Key kNoPoint = std::numeric_limits<Key>::infinity();

Key key_of(float distance2, int index) {
  return std::bit_cast<Key>(std::uint64_t{std::bit_cast<std::uint32_t>(distance2)} << 32U |
                            static_cast<std::uint32_t>(index));
}

int index_of(Key key) {
  return key == kNoPoint
             ? -1
             : static_cast<int>(static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(key)));
}

/// The least of some keys, which it spends, ascending; kNobody where there are too few. Each pass
/// keeps four and hands the others on. No step is a branch, which no processor could predict.
void keep_least(std::span<Key> keys, std::span<Key> least) {
  for (std::size_t done = 0; done < least.size(); done += 4) {
    Key a = kNoPoint, b = kNoPoint, c = kNoPoint, d = kNoPoint;
    for (Key& key : keys) {
      const Key past_a = std::max(a, key);
      a = std::min(a, key);
      const Key past_b = std::max(b, past_a);
      b = std::min(b, past_a);
      const Key past_c = std::max(c, past_b);
      c = std::min(c, past_b);
      key = std::max(d, past_c);
      d = std::min(d, past_c);
    }
    const std::array four{a, b, c, d};
    std::copy_n(four.begin(), std::min(four.size(), least.size() - done),
                least.begin() + static_cast<std::ptrdiff_t>(done));
  }
}

/// Points in the cells of a grid, those of a row of cells side by side in memory.
class Buckets {
 public:
  Buckets(const Points2& points, const std::vector<int>& among)
      : entries_(among.size()), found_(among.size() + 1) {
    const auto n = static_cast<double>(among.size());
    for (const int i : among) {
      for (std::size_t x = 0; x < 2; ++x) {
        const double coordinate = points(i, static_cast<Eigen::Index>(x));
        low_[x] = std::min(low_[x], coordinate);
        high_[x] = std::max(high_[x], coordinate);
      }
    }
    const double width = high_[0] - low_[0], height = high_[1] - low_[1];
    const double least = std::max(width, height) * kInCell / n;
    const double side = std::max(std::sqrt(width * height * kInCell / n), least);
    fill(points, among, side > 0.0 ? side : 1.0);
    // Where most points crowd into a part of the box, its cells are too full.
    const double crowd = crowd_beside_each();
    if (crowd > kTooFull * kInCell && least > 0.0) {
      fill(points, among, std::max(side * std::sqrt(kInCell / crowd), least));
    }
  }

  /// The keys of the nearest but `self`, from ever larger blocks of cells.
  void search(const Eigen::RowVector2d& from, int self, std::span<Key> nearest) {
    const int column = cell_along(from.x(), 0, columns_), row = cell_along(from.y(), 1, rows_);
    for (int reach = 1;; reach *= 2) {
      const Block block{std::max(column - reach, 0), std::min(column + reach, columns_ - 1),
                        std::max(row - reach, 0), std::min(row + reach, rows_ - 1)};
      const double outside = distance_outside(from, block);
      const std::size_t count = gather(from, self, block, static_cast<float>(outside * outside));
      if (count < nearest.size() && outside != kFar) continue;
      keep_least({found_.data(), count}, nearest);
      return;
    }
  }

 private:
  static constexpr double kFar = std::numeric_limits<double>::infinity();
  static constexpr double kFarthest = std::numeric_limits<float>::max();

  struct Entry {
    double x, y;
    int index;
  };

  /// Cells, the last ones included.
  struct Block {
    int left, right, top, bottom;
  };

  int cell_along(double coordinate, std::size_t axis, int cells) const {
    return std::clamp(static_cast<int>((coordinate - low_[axis]) / side_), 0, cells - 1);
  }
  double edge(int cell, std::size_t axis) const { return low_[axis] + cell * side_; }

  void fill(const Points2& points, const std::vector<int>& among, double side) {
    side_ = side;
    columns_ = 1 + static_cast<int>((high_[0] - low_[0]) / side_);
    rows_ = 1 + static_cast<int>((high_[1] - low_[1]) / side_);
    const auto cell_of = [&](int i) {
      return to_index(cell_along(points(i, 1), 1, rows_)) * to_index(columns_) +
             to_index(cell_along(points(i, 0), 0, columns_));
    };
    start_.assign(to_index(columns_) * to_index(rows_) + 1, 0);
    for (const int i : among) ++start_[cell_of(i) + 1];
    for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    for (const int i : among) entries_[next[cell_of(i)]++] = {points(i, 0), points(i, 1), i};
  }

  /// How many others are in the cell of a point, on average over the points.
  double crowd_beside_each() const {
    double pairs = 0.0;
    for (std::size_t c = 1; c < start_.size(); ++c) {
      const auto in_cell = static_cast<double>(start_[c] - start_[c - 1]);
      pairs += in_cell * (in_cell - 1.0);
    }
    return pairs / static_cast<double>(entries_.size());
  }

  /// How far all points outside a block are at least.
  double distance_outside(const Eigen::RowVector2d& from, const Block& block) const {
    return std::min({block.left > 0 ? from.x() - edge(block.left, 0) : kFar,
                     block.right < columns_ - 1 ? edge(block.right + 1, 0) - from.x() : kFar,
                     block.top > 0 ? from.y() - edge(block.top, 1) : kFar,
                     block.bottom < rows_ - 1 ? edge(block.bottom + 1, 1) - from.y() : kFar});
  }

  /// Writes the keys of those in a block that are nearer than `bound2`, and counts them.
  std::size_t gather(const Eigen::RowVector2d& from, int self, const Block& block, float bound2) {
    std::size_t count = 0;
    for (int y = block.top; y <= block.bottom; ++y) {
      const std::size_t first = to_index(y) * to_index(columns_);
      const std::size_t end = start_[first + to_index(block.right) + 1];
      for (std::size_t e = start_[first + to_index(block.left)]; e < end; ++e) {
        const Entry& entry = entries_[e];
        const double dx = entry.x - from.x(), dy = entry.y - from.y();
        const auto distance2 = static_cast<float>(std::min(kFarthest, dx * dx + dy * dy));
        found_[count] = key_of(distance2, entry.index);  // written over by the next if too far
        count += to_index(distance2 < bound2) & to_index(entry.index != self);
      }
    }
    return count;
  }

  std::array<double, 2> low_{kFar, kFar}, high_{-kFar, -kFar};
  double side_ = 1.0;
  int columns_ = 1, rows_ = 1;
  std::vector<std::size_t> start_;
  std::vector<Entry> entries_;
  std::vector<Key> found_;  // one longer than the entries
};

}  // namespace

Nearest nearest_of(const Points2& points, const std::vector<int>& among, int count) {
  Nearest nearest = Nearest::Constant(points.rows(), count, -1);
  if (among.empty() || count == 0) return nearest;
  Buckets buckets(points, among);
  std::vector<Key> keys(to_index(count));
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    worked(30 + 10 * count);
    buckets.search(points.row(i), static_cast<int>(i), keys);
    std::transform(keys.begin(), keys.end(), nearest.row(i).begin(), index_of);
  }
  return nearest;
}

}  // namespace weft::filters
