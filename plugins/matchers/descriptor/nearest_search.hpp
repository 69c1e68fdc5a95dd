// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/array.hpp>

#include "common/point_index.hpp"
#include "distance_rows.hpp"

namespace weft::descriptor {

/// The two nearest trains of a query; -1 where there is none.
struct Nearest {
  int best = -1;
  int second = -1;
};

/// Finds for each query the nearest train and the nearest one that lies elsewhere in the image.
/// The lowest index wins a tie.
class NearestSearch {
 public:
  struct Options {
    double elsewhere_px = 0.0;  ///< the second is farther than this from the best; 0: any other
    bool mutual = false;        ///< best_query() is wanted too
  };

  /// `places` [T,2] px of the trains. False when `cancelled` said so.
  bool run(const DistanceRows& distances, const Array<double>& places, const Options& options,
           const std::function<bool()>& cancelled);

  const std::vector<Nearest>& nearest() const { return nearest_; }
  /// The query nearest to a train, if `mutual` was set.
  int best_query(int train) const { return best_query_[to_index(train)]; }

 private:
  void look_back(int query, const float* row);

  matchers::PointIndex places_;
  std::vector<float> rows_;
  std::vector<Nearest> nearest_;
  std::vector<float> best_query_distance_;
  std::vector<int> best_query_;
};

}  // namespace weft::descriptor
