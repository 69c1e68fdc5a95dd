// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <limits>
#include <vector>
#include <weft/data/array.hpp>

#include "common/distances/coarse_distances.hpp"
#include "common/distances/nearest_two.hpp"
#include "common/point_grid.hpp"
#include "common/workers/workers.hpp"

namespace weft::descriptor {

using matchers::Nearest;

/// Finds for each query the nearest train and the nearest one that lies elsewhere in the image,
/// exactly. The lowest index wins a tie.
class NearestSearch {
 public:
  struct Options {
    double elsewhere_px = 0.0;  ///< the second is farther than this from the best; 0: any other
    bool mutual = false;        ///< a best whose own nearest is another query is no best
    /// Queries whose distance is not below this times the second one may have no best.
    double ratio = std::numeric_limits<double>::infinity();
    int threads = 1;
  };

  /// `places` [T,2] px of the trains. Returns false when `cancelled`, called on the caller's
  /// thread, returns true.
  bool run(matchers::CoarseDistances& distances, const Array<double>& places,
           const Options& options, const std::function<bool()>& cancelled);

  const std::vector<Nearest>& nearest() const { return nearest_; }

 private:
  /// The buffers of one thread.
  struct Bench {
    matchers::CoarseDistances::Scratch scratch;
    std::vector<std::int16_t> codes;
    matchers::NearestTwo two;
  };
  using Visit = std::function<void(Bench&, int query)>;

  bool for_each_row(matchers::CoarseDistances& distances, const std::vector<int>& queries,
                    int threads, const std::function<bool()>& cancelled, const Visit& visit);
  bool keep_mutual(matchers::CoarseDistances& distances, int threads,
                   const std::function<bool()>& cancelled);

  Workers workers_;
  std::vector<Bench> benches_;
  matchers::PointGrid places_;
  std::vector<int> queries_;
  std::vector<Nearest> nearest_;
  std::vector<int> best_query_;
};

}  // namespace weft::descriptor
