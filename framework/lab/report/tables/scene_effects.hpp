// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "lab/results/results.hpp"
#include "lab/statistics/comparison.hpp"

namespace weft::lab {

/// The difference between two values of an axis on one sequence or on a kind of data.
struct SceneEffect {
  std::string scene;
  double mean = kUnknown;  ///< a - b, in the unit of the metric
  /// 95 % interval of the mean. For one sequence, by a bootstrap over stretches of consecutive
  /// frames, six a seed. For a kind of data, as in PairedTest, over its sequences.
  Interval interval;
  std::int64_t n = 0;  ///< [] sequences
};

/// Differences by seed, frame after frame.
using FrameDifferences = std::map<std::uint64_t, std::vector<double>>;

/// The effect on one sequence.
SceneEffect frame_effect(const std::string& sequence, const FrameDifferences& differences);

/// The scenes of a comparison in the order of the plan, pair by pair in the order of `pairs`. A
/// scene is a sequence or, in plans with many, a kind of data. A scene in which a pair never has
/// two values is omitted.
std::vector<std::vector<SceneEffect>> scene_effects(const Results& results,
                                                    const PlanComparison& plan,
                                                    const std::vector<PairComparison>& pairs);

}  // namespace weft::lab
