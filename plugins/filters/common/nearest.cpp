// SPDX-License-Identifier: Apache-2.0
#include "common/nearest.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace weft::filters {
namespace {

constexpr double kInCell = 3.0;   // points on average: 9 cells mostly hold the 8 nearest
constexpr double kTooFull = 1.5;  // times as many

/// A squared distance and an index in one number: the nearer first, then the smaller index.
using Key = std::uint64_t;
constexpr Key kNobody = Key{0xffffffffU} << 32U | 0xffffffffU;

Key key_of(double distance2, int index) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(distance2));
  return Key{bits} << 32U | static_cast<std::uint32_t>(index);
}

/// The nearest points found so far, nearest first, in memory that it does not own.
struct Shortlist {
  Key* keys;
  int size;

  void clear() { std::fill_n(keys, size, kNobody); }

  /// The square of the largest distance; infinite until the list is full.
  double worst2() const {
    const Key last = keys[size - 1];
    if (last == kNobody) return std::numeric_limits<double>::infinity();
    return std::bit_cast<float>(static_cast<std::uint32_t>(last >> 32U));
  }

  void offer(Key key) {
    if (key >= keys[size - 1]) return;
    int at = size - 1;
    for (; at > 0 && keys[at - 1] > key; --at) keys[at] = keys[at - 1];
    keys[at] = key;
  }
};

/// Points in the cells of a grid, those of a row of cells side by side in memory.
class Buckets {
 public:
  Buckets(const Points2& points, const std::vector<int>& among) {
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

  /// The nearest but `self`, searching ever larger blocks of cells.
  void search(const Eigen::RowVector2d& from, int self, Shortlist& nearest) const {
    const int column = cell_along(from.x(), 0, columns_), row = cell_along(from.y(), 1, rows_);
    for (int reach = 1;;) {
      nearest.clear();
      const int left = std::max(column - reach, 0), right = std::min(column + reach, columns_ - 1);
      const int top = std::max(row - reach, 0), bottom = std::min(row + reach, rows_ - 1);
      search_row(from, self, left, right, row, nearest);  // the likeliest first
      for (int y = top; y <= bottom; ++y) {
        if (y != row) search_row(from, self, left, right, y, nearest);
      }
      const double outside = std::min({left > 0 ? from.x() - edge(left, 0) : kFar,
                                       right < columns_ - 1 ? edge(right + 1, 0) - from.x() : kFar,
                                       top > 0 ? from.y() - edge(top, 1) : kFar,
                                       bottom < rows_ - 1 ? edge(bottom + 1, 1) - from.y() : kFar});
      const double worst2 = nearest.worst2();
      if (outside == kFar || worst2 < outside * outside) return;
      // A full list says how far to look.
      reach = worst2 == kFar
                  ? 2 * reach
                  : std::max(reach + 1, static_cast<int>(std::ceil(std::sqrt(worst2) / side_)));
    }
  }

 private:
  static constexpr double kFar = std::numeric_limits<double>::infinity();

  struct Entry {
    double x, y;
    int index;
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
      return static_cast<std::size_t>(cell_along(points(i, 1), 1, rows_)) *
                 static_cast<std::size_t>(columns_) +
             static_cast<std::size_t>(cell_along(points(i, 0), 0, columns_));
    };
    start_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
    for (const int i : among) ++start_[cell_of(i) + 1];
    for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    entries_.resize(among.size());
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

  void search_row(const Eigen::RowVector2d& from, int self, int left, int right, int row,
                  Shortlist& nearest) const {
    const std::size_t first = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
    const std::size_t end = start_[first + static_cast<std::size_t>(right) + 1];
    for (std::size_t e = start_[first + static_cast<std::size_t>(left)]; e < end; ++e) {
      const Entry& entry = entries_[e];
      if (entry.index == self) continue;
      const double dx = entry.x - from.x(), dy = entry.y - from.y();
      nearest.offer(key_of(dx * dx + dy * dy, entry.index));
    }
  }

  std::array<double, 2> low_{kFar, kFar}, high_{-kFar, -kFar};
  double side_ = 1.0;
  int columns_ = 1, rows_ = 1;
  std::vector<std::size_t> start_;
  std::vector<Entry> entries_;
};

}  // namespace

Nearest nearest_of(const Points2& points, const std::vector<int>& among, int count) {
  Nearest nearest = Nearest::Constant(points.rows(), count, -1);
  if (among.empty() || count == 0) return nearest;
  const Buckets buckets(points, among);
  std::vector<Key> keys(static_cast<std::size_t>(count));
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    Shortlist shortlist{keys.data(), count};
    buckets.search(points.row(i), static_cast<int>(i), shortlist);
    for (int k = 0; k < count; ++k) {
      nearest(i, k) =
          static_cast<int>(static_cast<std::uint32_t>(keys[static_cast<std::size_t>(k)]));
    }
  }
  return nearest;
}

}  // namespace weft::filters
