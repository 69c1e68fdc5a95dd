// SPDX-License-Identifier: Apache-2.0
#include "nearest_search.hpp"

#include <algorithm>
#include <limits>
#include <weft/core/index.hpp>

namespace weft::descriptor {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kLanes = 4;
typedef float FourFloats __attribute__((vector_size(kLanes * sizeof(float))));
typedef float FourFloatsInMemory
    __attribute__((vector_size(kLanes * sizeof(float)), aligned(alignof(float)), may_alias));

/// The smallest of kRowMultiple values.
float block_minimum(const float* values) {
  const auto* vectors = reinterpret_cast<const FourFloatsInMemory*>(values);
  FourFloats low = vectors[0], high = vectors[1];
  for (int i = 2; i < kRowMultiple / kLanes; i += 2) {
    const FourFloats a = vectors[i], b = vectors[i + 1];
    low = a < low ? a : low;
    high = b < high ? b : high;
  }
  low = high < low ? high : low;
  return std::min(std::min(low[0], low[1]), std::min(low[2], low[3]));
}

/// Index of the smallest value, the first of equal ones; -1 if none is finite.
int smallest(const float* row, int row_length) {
  float minimum = kInfinity;
  int block = -1;
  for (int first = 0; first < row_length; first += kRowMultiple) {
    const float candidate = block_minimum(row + first);
    if (candidate < minimum) {
      minimum = candidate;
      block = first;
    }
  }
  if (block < 0) return -1;
  return static_cast<int>(std::find(row + block, row + block + kRowMultiple, minimum) - row);
}

}  // namespace

void NearestSearch::look_back(int query, const float* row) {
  for (std::size_t j = 0; j < best_query_.size(); ++j) {
    const bool closer = row[j] < best_query_distance_[j];
    best_query_distance_[j] = closer ? row[j] : best_query_distance_[j];
    best_query_[j] = closer ? query : best_query_[j];
  }
}

bool NearestSearch::run(const DistanceRows& distances, const Array<double>& places,
                        const Options& options, const std::function<bool()>& cancelled) {
  const auto place = [&](int i) { return Eigen::Vector2d(places(i, 0), places(i, 1)); };
  if (options.elsewhere_px > 0.0) places_.load(distances.trains(), place);
  const int length = distances.row_length();
  const std::size_t trains = options.mutual ? to_index(distances.trains()) : 0;
  best_query_distance_.assign(trains, kInfinity);
  best_query_.assign(trains, -1);
  nearest_.assign(to_index(distances.queries()), {});
  rows_.resize(to_index(kBlockRows) * to_index(length));

  for (int first = 0; first < distances.queries(); first += kBlockRows) {
    if (cancelled()) return false;
    distances.fill(first, rows_.data());
    const int last = std::min(first + kBlockRows, distances.queries());
    for (int query = first; query < last; ++query) {
      float* row = rows_.data() + static_cast<std::ptrdiff_t>(query - first) * length;
      if (options.mutual) look_back(query, row);
      Nearest& found = nearest_[to_index(query)];
      found.best = smallest(row, length);
      if (found.best < 0) continue;
      row[found.best] = kInfinity;
      if (options.elsewhere_px > 0.0) {
        places_.for_each_within(place(found.best), options.elsewhere_px,
                                [&](int near) { row[near] = kInfinity; });
      }
      found.second = smallest(row, length);
    }
  }
  return true;
}

}  // namespace weft::descriptor
