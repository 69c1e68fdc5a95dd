// SPDX-License-Identifier: Apache-2.0
#include "lab/report/tables/scene_effects.hpp"

#include <algorithm>
#include <span>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

#include "lab/report/tables/statistics.hpp"
#include "lab/statistics/bootstrap.hpp"

namespace weft::lab {
namespace {

constexpr std::size_t kMostSequences = 24;  ///< that a figure has a row for
constexpr std::size_t kStretches = 6;       ///< parts of the frames of a seed

/// Means of stretches of consecutive frames, of nearly equal length: neighbouring frames are
/// correlated, stretches much less.
void add_stretches(std::span<const double> frames, std::vector<double>& means) {
  const std::size_t stretches = std::min(kStretches, frames.size());
  for (std::size_t i = 0; i < stretches; ++i) {
    const std::size_t from = i * frames.size() / stretches;
    means.push_back(mean(frames.subspan(from, (i + 1) * frames.size() / stretches - from)));
  }
}

/// One entry for each sequence in which both have a value somewhere.
std::map<std::string, SceneEffect> effects_by_sequence(const Panel& panel,
                                                       const PairComparison& pair) {
  const auto place_of = [&](const std::string& name) {
    return to_index(std::find(panel.treatments.begin(), panel.treatments.end(), name) -
                    panel.treatments.begin());
  };
  const std::size_t a = place_of(pair.a), b = place_of(pair.b);
  std::map<std::string, FrameDifferences> differences;
  for (const PanelRow& row : panel.rows) {
    if (!row.has_value(a) || !row.has_value(b)) continue;
    differences[row.place.sequence][row.place.seed].push_back(*row.results[a] - *row.results[b]);
  }
  std::map<std::string, SceneEffect> effects;
  for (const auto& [sequence, each] : differences) effects[sequence] = frame_effect(sequence, each);
  return effects;
}

/// The kinds of data of a plan with more sequences than rows.
std::vector<SceneEffect> gathered(const PlanRecord& plan,
                                  const std::map<std::string, SceneEffect>& by_sequence) {
  std::vector<SceneEffect> scenes;
  for (const PlanData& data : plan.data) {
    std::vector<double> means;
    for (const std::string& sequence : data.sequences) {
      const auto effect = by_sequence.find(sequence);
      if (effect != by_sequence.end()) means.push_back(effect->second.mean);
    }
    if (means.empty()) continue;
    const PairedTest test = test_differences(means);
    scenes.push_back({data.name, test.mean, test.interval, test.n});
  }
  return scenes;
}

}  // namespace

SceneEffect frame_effect(const std::string& sequence, const FrameDifferences& differences) {
  std::vector<double> seeds, stretches;
  for (const auto& [seed, frames] : differences) {
    seeds.push_back(mean(frames));
    add_stretches(frames, stretches);
  }
  return {sequence, mean(seeds), bootstrap_interval(stretches), 1};
}

std::vector<std::vector<SceneEffect>> scene_effects(const Results& results,
                                                    const PlanComparison& plan,
                                                    const std::vector<PairComparison>& pairs) {
  std::vector<std::vector<SceneEffect>> effects;
  if (pairs.empty()) return effects;
  const auto panel = make_panel(observations_of(results, plan));
  for (const PairComparison& pair : pairs) {
    std::vector<SceneEffect>& scenes = effects.emplace_back();
    if (!panel) continue;
    const auto by_sequence = effects_by_sequence(*panel, pair);
    if (results.plan.sequences.size() > kMostSequences) {
      scenes = gathered(results.plan, by_sequence);
      continue;
    }
    for (const std::string& sequence : results.plan.sequences) {
      const auto effect = by_sequence.find(sequence);
      if (effect != by_sequence.end()) scenes.push_back(effect->second);
    }
  }
  return effects;
}

}  // namespace weft::lab
