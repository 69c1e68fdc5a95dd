// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace weft::descriptor {

/// Queries whose distances are computed together.
inline constexpr int kBlockRows = 24;
/// Lengths of rows of distances are multiples of this.
inline constexpr int kRowMultiple = 64;

/// Distances from each of a set of query descriptors to all of a set of train descriptors.
class DistanceRows {
 public:
  virtual ~DistanceRows() = default;

  int queries() const { return queries_; }
  int trains() const { return trains_; }
  /// Elements of a row: trains() rounded up to a multiple of kRowMultiple.
  int row_length() const { return (trains_ + kRowMultiple - 1) / kRowMultiple * kRowMultiple; }

  /// A monotonic measure of the distances of queries first, first + 1 ... up to kBlockRows of them,
  /// into rows [kBlockRows, row_length()]; beyond trains() it is infinite.
  virtual void fill(int first, float* rows) const = 0;

  /// The distance itself, computed from the two descriptors.
  virtual double distance(int query, int train) const = 0;

 protected:
  int queries_ = 0;
  int trains_ = 0;
};

}  // namespace weft::descriptor
