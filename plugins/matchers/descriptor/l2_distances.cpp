// SPDX-License-Identifier: Apache-2.0
#include "l2_distances.hpp"

#include <cmath>
#include <limits>
#include <weft/core/index.hpp>

namespace weft::descriptor {
namespace {

constexpr int kTileRows = 6;
static_assert(kBlockRows % kTileRows == 0);

template <int Lanes>
struct Vector {
  static constexpr int kBytes = Lanes * static_cast<int>(sizeof(float));
  typedef float Register __attribute__((vector_size(kBytes)));
  typedef float Memory __attribute__((vector_size(kBytes), aligned(alignof(float)), may_alias));

  static const Memory& at(const float* data) { return *reinterpret_cast<const Memory*>(data); }
  static Memory& at(float* data) { return *reinterpret_cast<Memory*>(data); }
};

/// Six queries [6,length] against a panel [length, 2 Lanes]: 12 sums that stay in registers.
template <int Lanes>
[[gnu::always_inline]] inline void fill_tile(const float* queries, const float* query_norms,
                                             const float* panel, const float* train_norms,
                                             int length, float* rows, std::ptrdiff_t row_length) {
  using V = Vector<Lanes>;
  typename V::Register low[kTileRows]{}, high[kTileRows]{};
  for (std::ptrdiff_t k = 0; k < length; ++k) {
    const typename V::Register a = V::at(panel + 2 * Lanes * k);
    const typename V::Register b = V::at(panel + 2 * Lanes * k + Lanes);
#pragma GCC unroll 6
    for (int r = 0; r < kTileRows; ++r) {
      const float query = queries[static_cast<std::ptrdiff_t>(r) * length + k];
      low[r] += query * a;
      high[r] += query * b;
    }
  }
#pragma GCC unroll 6
  for (int r = 0; r < kTileRows; ++r) {
    float* row = rows + r * row_length;
    V::at(row) = (query_norms[r] + V::at(train_norms)) - 2.0F * low[r];
    V::at(row + Lanes) = (query_norms[r] + V::at(train_norms + Lanes)) - 2.0F * high[r];
  }
}

/// The panel is the outer loop: it stays in the nearest cache for all queries of the block.
template <int Lanes>
[[gnu::always_inline]] inline void fill_block(const float* queries, const float* query_norms,
                                              int row_length, const float* panels,
                                              const float* train_norms, int length, float* rows) {
  for (std::ptrdiff_t j = 0; j < row_length; j += 2 * Lanes) {
    for (std::ptrdiff_t i = 0; i < kBlockRows; i += kTileRows) {
      fill_tile<Lanes>(queries + i * length, query_norms + i, panels + j * length, train_norms + j,
                       length, rows + i * row_length + j, row_length);
    }
  }
}

void fill_plain(const float* queries, const float* query_norms, int row_length, const float* panels,
                const float* train_norms, int length, float* rows) {
  fill_block<4>(queries, query_norms, row_length, panels, train_norms, length, rows);
}

#ifdef __x86_64__
[[gnu::target("avx2,fma")]] void fill_avx2(const float* queries, const float* query_norms,
                                           int row_length, const float* panels,
                                           const float* train_norms, int length, float* rows) {
  fill_block<8>(queries, query_norms, row_length, panels, train_norms, length, rows);
}

bool has_avx2() { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }
#endif

int rounded_up(int count, int multiple) { return (count + multiple - 1) / multiple * multiple; }

/// sqrt(d / |d|_1) elementwise.
void take_root(float* descriptor, int length) {
  double sum = 0.0;
  for (int k = 0; k < length; ++k) sum += std::abs(static_cast<double>(descriptor[k]));
  if (sum == 0.0) return;
  for (int k = 0; k < length; ++k) {
    descriptor[k] = static_cast<float>(std::sqrt(static_cast<double>(descriptor[k]) / sum));
  }
}

}  // namespace

L2Distances::L2Distances([[maybe_unused]] bool wide) : fill_(&fill_plain), panel_width_(8) {
#ifdef __x86_64__
  if (wide && has_avx2()) {
    fill_ = &fill_avx2;
    panel_width_ = 16;
  }
#endif
}

void L2Distances::Side::load(const Array<float>& descriptors, bool root, int padded_count) {
  const auto length = static_cast<int>(descriptors.dim(1));
  const auto padded = to_index(padded_count);
  rows.assign(padded * to_index(length), 0.0F);
  norms.assign(padded, std::numeric_limits<float>::infinity());
  for (std::int64_t i = 0; i < descriptors.dim(0); ++i) {
    float* row = rows.data() + i * length;
    std::copy_n(descriptors.row(i), length, row);
    if (root) take_root(row, length);
    float norm = 0.0F;
    for (int k = 0; k < length; ++k) norm += row[k] * row[k];
    norms[to_index(i)] = norm;
  }
}

void L2Distances::load(const Array<float>& queries, const Array<float>& trains, bool root) {
  queries_ = static_cast<int>(queries.dim(0));
  trains_ = static_cast<int>(trains.dim(0));
  length_ = static_cast<int>(queries.dim(1));
  queries_side_.load(queries, root, rounded_up(queries_, kBlockRows));
  trains_side_.load(trains, root, row_length());
  pack_trains();
}

void L2Distances::pack_trains() {
  panels_.resize(trains_side_.rows.size());
  const std::ptrdiff_t width = panel_width_, length = length_;
  for (std::ptrdiff_t first = 0; first < row_length(); first += width) {
    float* panel = panels_.data() + first * length;
    for (std::ptrdiff_t lane = 0; lane < width; ++lane) {
      const float* row = trains_side_.rows.data() + (first + lane) * length;
      for (std::ptrdiff_t k = 0; k < length; ++k) panel[k * width + lane] = row[k];
    }
  }
}

void L2Distances::fill(int first, float* rows) const {
  fill_(queries_side_.row(first, length_), queries_side_.norms.data() + first, row_length(),
        panels_.data(), trains_side_.norms.data(), length_, rows);
}

double L2Distances::distance(int query, int train) const {
  const float* a = queries_side_.row(query, length_);
  const float* b = trains_side_.row(train, length_);
  double sum = 0.0;
  for (int k = 0; k < length_; ++k) {
    const double difference = static_cast<double>(a[k]) - static_cast<double>(b[k]);
    sum += difference * difference;
  }
  return std::sqrt(sum);
}

}  // namespace weft::descriptor
