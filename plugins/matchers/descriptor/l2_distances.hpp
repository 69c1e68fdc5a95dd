// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/data/array.hpp>

#include "distance_rows.hpp"

namespace weft::descriptor {

/// Squared L2 distances |a|^2 + |b|^2 - 2 a.b, the products by tiles of six queries and two vectors
/// of trains that stay in registers. Each product is summed in the same order wherever its
/// descriptors stand, so distances do not depend on the order of the descriptors.
class L2Distances final : public DistanceRows {
 public:
  /// `wide`: use AVX2 and FMA where the processor has them.
  explicit L2Distances(bool wide = true);

  /// Descriptors [Q,D] and [T,D]. With `root`, each is replaced by sqrt(d / |d|_1) elementwise
  /// (RootSIFT, Arandjelovic and Zisserman 2012), which needs d >= 0; zero stays zero.
  void load(const Array<float>& queries, const Array<float>& trains, bool root);

  void fill(int first, float* rows) const override;
  double distance(int query, int train) const override;

  const float* query(int i) const { return queries_side_.row(i, length_); }

 private:
  using Fill = void (*)(const float* queries, const float* query_norms, int row_length,
                        const float* panels, const float* train_norms, int length, float* rows);

  struct Side {
    std::vector<float> rows;   ///< [count rounded up, D]
    std::vector<float> norms;  ///< squared

    void load(const Array<float>& descriptors, bool root, int padded_count);
    const float* row(int i, int length) const {
      return rows.data() + static_cast<std::ptrdiff_t>(i) * length;
    }
  };

  void pack_trains();

  Fill fill_;
  int panel_width_;
  int length_ = 0;
  Side queries_side_, trains_side_;
  std::vector<float> panels_;  ///< [row_length / panel_width, D, panel_width]
};

}  // namespace weft::descriptor
