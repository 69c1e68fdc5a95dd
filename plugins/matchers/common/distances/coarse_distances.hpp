// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace weft::matchers {

/// Queries whose distances to all trains are computed together, at most.
inline constexpr int kBlockQueries = 24;
/// Lengths of rows of codes are multiples of this.
inline constexpr int kCodeBlock = 64;
/// The code of all positions beyond the last train; no pair has it.
inline constexpr std::int16_t kBeyond = 32767;

/// Distances between two sets of descriptors: coarse ones, of very many pairs at once, and the
/// distance itself, of the few pairs that the coarse ones leave in question.
///
/// A coarse distance is a code c with lower(q, c) <= distance(q, t) <= upper(q, c), both rising
/// with c; it is the same on every processor. Decisions by these bounds and, where they leave a
/// doubt, by distances are therefore exact.
class CoarseDistances {
 public:
  /// Memory that a fill() works in, one for each thread.
  struct Scratch {
    std::vector<std::uint64_t> words;
    std::vector<std::uint32_t> groups;
    std::vector<std::int32_t> halves;
  };

  virtual ~CoarseDistances() = default;

  int queries() const { return queries_; }
  int trains() const { return trains_; }
  /// Codes of a row: trains() rounded up to a multiple of kCodeBlock.
  int row_length() const { return (trains_ + kCodeBlock - 1) / kCodeBlock * kCodeBlock; }

  /// Codes of up to kBlockQueries queries and all trains into [kBlockQueries, row_length()], after
  /// pack_trains(); what is beyond trains(), or beyond the queries, holds kBeyond or anything.
  virtual void fill(std::span<const int> queries, Scratch& scratch, std::int16_t* codes) const = 0;
  virtual void pack_trains() = 0;

  /// Codes of one query and some trains.
  virtual void fill_some(int query, std::span<const int> trains, std::int16_t* codes) const = 0;

  virtual double lower(int query, int code) const = 0;
  virtual double upper(int query, int code) const = 0;
  /// The last code whose lower bound is not above a distance, below kBeyond.
  virtual int last_code(int query, double distance) const = 0;
  /// Within fine_slack() of the distance, and faster than it.
  virtual double fine_distance(int query, int train) const = 0;
  virtual double fine_slack(int query) const = 0;

  /// Computed from the two descriptors.
  virtual double distance(int query, int train) const = 0;

  /// Queries become trains, trains queries.
  virtual void swap_sides() = 0;

 protected:
  int queries_ = 0;
  int trains_ = 0;
};

}  // namespace weft::matchers
