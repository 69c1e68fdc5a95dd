// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lab/results/results.hpp"
#include "lab/statistics/comparison.hpp"

namespace weft::lab {

/// How far two values of an axis are apart on one sequence or on a kind of data.
struct SceneEffect {
  std::string scene;
  double mean = kUnknown;  ///< a - b, in the unit of the metric
  /// 95 % of the mean. Of one sequence: by a bootstrap over stretches of consecutive frames, six a
  /// seed. Of a kind of data: as in PairedTest, over its sequences.
  Interval interval;
  std::int64_t n = 0;  ///< [] sequences
};

/// The scenes of a comparison, pair by pair in the order of `pairs`; in the order of the plan. A
/// scene is a sequence or, of plans with many, a kind of data; one in which a pair never has two
/// values is left out.
std::vector<std::vector<SceneEffect>> scene_effects(const Results& results,
                                                    const PlanComparison& plan,
                                                    const std::vector<PairComparison>& pairs);

}  // namespace weft::lab
