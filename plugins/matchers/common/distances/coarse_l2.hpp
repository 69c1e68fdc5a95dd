// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/array.hpp>

#include "common/distances/byte_kernels.hpp"
#include "common/distances/coarse_distances.hpp"
#include "common/distances/row_kernels.hpp"
#include "common/workers/workers.hpp"

namespace weft::matchers {

/// L2 distances. Coarse distances are those of descriptors rounded to bytes, a ~ b / s + o with one
/// scale s and one offset o for both sides. The triangle inequality bounds s |a - a'| to within
/// e(a) + e(a') of |b - b'|. The error e(a) = |s (a - o) - b| of each descriptor is computed when
/// it is rounded. Fine distances use descriptors rounded to 16 bits in the same way.
class CoarseL2 final : public CoarseDistances {
 public:
  explicit CoarseL2(const ByteKernels& kernels = byte_kernels().front()) : kernels_(&kernels) {}

  /// Finite descriptors [Q,D] and [T,D], which must outlive this. With `root`, those of ComparedRow
  /// are compared in their place. A side of the same revision as before, not 0, is the same as
  /// before: what was made of it is kept. The same on any number of threads.
  void load(const Array<float>& queries, const Array<float>& trains, bool root,
            std::uint64_t query_revision = 0, std::uint64_t train_revision = 0, int threads = 1);

  void fill(std::span<const int> queries, Scratch& scratch, std::int16_t* codes) const override;
  void pack_trains() override;
  void fill_some(int query, std::span<const int> trains, std::int16_t* codes) const override;
  double lower(int query, int code) const override;
  double upper(int query, int code) const override;
  int last_code(int query, double distance) const override;
  double fine_distance(int query, int train) const override;
  double fine_slack(int query) const override;
  double distance(int query, int train) const override;
  void swap_sides() override;

 private:
  struct Range {
    float lowest = 0.0F;        ///< minimum of all numbers, at most 0
    double largest_norm = 0.0;  ///< largest norm of a row from which `lowest` is subtracted
  };

  /// The parameters of the rounding of rows.
  struct Rounding {
    float lowest = 0.0F, scale = 0.0F;
    int row_bytes = 0;
    bool operator==(const Rounding&) const = default;
  };

  /// One set of descriptors; bytes and halves are padded to a multiple of kCodeBlock rows.
  struct Side {
    std::vector<ComparedRow> rows;
    std::vector<std::uint8_t> bytes;   ///< [K, row_bytes]
    std::vector<std::int16_t> fine;    ///< [K, row_bytes]
    std::vector<std::int32_t> halves;  ///< [K] half of the squared norms, rounded up
    std::vector<float> errors;         ///< [K], in bytes
    std::vector<float> fine_errors;    ///< [K], in bytes
    std::vector<std::uint8_t> panels;  ///< [K / kPanelTrains, groups, kPanelTrains, kGroupBytes]
    float largest_error = 0.0F;
    float largest_fine_error = 0.0F;
    bool is_packed = false;
    std::uint64_t revision = 0;  ///< revision of the data in the rows
    bool root = false;
    Range range;
    Rounding rounding;  ///< rounding of the bytes; scale 0 for none

    int count() const { return static_cast<int>(rows.size()); }
    void load(const Array<float>& descriptors, bool with_root, std::uint64_t new_revision,
              Workers& workers, int threads);
    void quantise(const Rounding& wanted, Workers& workers, int threads);
    void pack();
  };

  Range range_of_both() const;
  double slack(int query) const;

  const ByteKernels* kernels_;
  Workers workers_;
  Side query_side_, train_side_;
  int length_ = 0, row_bytes_ = 0;
  double scale_ = 1.0;
};

}  // namespace weft::matchers
