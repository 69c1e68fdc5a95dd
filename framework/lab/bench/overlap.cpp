// SPDX-License-Identifier: Apache-2.0
#include "lab/bench/overlap.hpp"

#include <weft/core/index.hpp>

namespace weft::bench {
namespace {

/// [ms] from one frame that counts to the next: without what the first ones take to fill the
/// pipeline, where some warm up.
double period_ms(const Overlapped& repetition, std::int64_t warmup) {
  const auto& frames = repetition.frames;
  const auto counted = static_cast<double>(frames.size()) - static_cast<double>(warmup);
  const double begin_ms =
      warmup > 0 ? frames[to_index(warmup) - 1].left_ms : frames.front().entered_ms;
  return (frames.back().left_ms - begin_ms) / counted;
}

}  // namespace

Result<std::vector<std::vector<Overlapped>>> measure_overlap(const Settings& settings,
                                                             std::span<Subject* const> subjects,
                                                             const Progress& progress) {
  Settings whole = settings;
  whole.block = whole.frames;
  std::vector<std::vector<Overlapped>> repetitions(subjects.size());
  const std::vector<Turn> turns = schedule(whole, subjects.size());
  for (std::size_t i = 0; i < turns.size(); ++i) {
    auto run = subjects[turns[i].pipeline]->run_overlapping(turns[i].end);
    if (!run) return run.error();
    repetitions[turns[i].pipeline].push_back(*std::move(run));
    if (progress) progress(i + 1, turns.size());
  }
  return repetitions;
}

OverlapFigures figures_of(const std::vector<Overlapped>& repetitions, std::int64_t warmup) {
  OverlapFigures figures;
  std::vector<double> latencies_ms;
  host::Spent all;
  for (const Overlapped& repetition : repetitions) {
    figures.frames_per_s.push_back(1e3 / period_ms(repetition, warmup));
    for (std::size_t i = to_index(warmup); i < repetition.frames.size(); ++i) {
      latencies_ms.push_back(repetition.frames[i].left_ms - repetition.frames[i].entered_ms);
    }
    all.ms += repetition.whole.ms;
    all.processor_ms += repetition.whole.processor_ms;
  }
  figures.frames_per_s_spread = spread_of(figures.frames_per_s);
  figures.latency_ms = spread_of(latencies_ms);
  if (all.ms > 0.0) figures.cores = all.processor_ms / all.ms;
  return figures;
}

Part overlapped_part(const std::vector<Overlapped>& repetitions, std::int64_t warmup) {
  Part part{kOverlap, {}, {}};
  for (std::size_t i = 0; i < repetitions.size(); ++i) {
    const Overlapped& each = repetitions[i];
    const host::Spent took{period_ms(each, warmup),
                           each.whole.processor_ms / static_cast<double>(each.frames.size()),
                           {}};
    part.samples.push_back({static_cast<std::int64_t>(i), static_cast<int>(i), 0, took});
  }
  return part;
}

}  // namespace weft::bench
