// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/distances/coarse_distances.hpp"
#include "common/distances/nearest_two.hpp"
#include "common/point_grid.hpp"
#include "common/workers/workers.hpp"

namespace weft::guided {

/// The places of the descriptors of one side. Predicted places are in the image [px], NaN where
/// unknown; the others are on the side itself, in the template or image [px].
struct SidePlaces {
  std::vector<Eigen::Vector2d> in_image;
  std::vector<Eigen::Vector2d> at_home;
};

/// The nearest two descriptors of each query among the trains in a circle around its place in the
/// image, exactly. The lowest index wins a tie.
///
/// Where the circle holds few trains, others, spread evenly over all trains, are rivals: they are
/// no match, but may be second, so that being alone makes no match distinctive. A rival nearer than
/// the best is a second nearer than the best.
///
/// The result does not depend on the number of threads.
class CircleSearch {
 public:
  struct Options {
    double radius_px = 30.0;    ///< radius of the circles
    double elsewhere_px = 0.0;  ///< the second is farther than this from the best; 0: any other
    int least_rivals = 0;       ///< a best is compared with at least as many trains
    double ratio = 1.0;         ///< queries that do not pass this may have no best
    bool mutual = false;        ///< a best whose own nearest is another query is no best
    int threads = 1;
  };

  const std::vector<matchers::Nearest>& run(matchers::CoarseDistances& distances,
                                            const SidePlaces& queries, const SidePlaces& trains,
                                            const Options& options);

 private:
  /// The buffers of one thread.
  struct Bench {
    std::vector<int> in_reach;  ///< trains in the circle
    std::vector<std::int16_t> codes, rival_codes;
    matchers::NearestTwo two;
  };

  template <class Visit>
  void for_each_query(const Options& options, Visit&& visit);
  matchers::Nearest search(const matchers::CoarseDistances& distances, int query,
                           const Eigen::Vector2d& place, const SidePlaces& trains,
                           const Options& options, Bench& bench) const;
  void add_rivals(const matchers::CoarseDistances& distances, int query, const SidePlaces& trains,
                  const Options& options, Bench& bench, matchers::Nearest& found) const;
  void keep_mutual(matchers::CoarseDistances& distances, const SidePlaces& queries,
                   const SidePlaces& trains, const Options& options);
  void lay_out(const std::vector<Eigen::Vector2d>& in_image, double radius_px);

  Workers workers_;
  std::vector<Bench> benches_;
  matchers::PointGrid grid_;
  std::vector<int> placed_;  ///< trains whose place is known
  std::vector<int> rivals_;  ///< trains from all over
  std::vector<matchers::Nearest> nearest_;
};

}  // namespace weft::guided
