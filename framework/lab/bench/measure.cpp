// SPDX-License-Identifier: Apache-2.0
#include "lab/bench/measure.hpp"

namespace weft::bench {

FrameSpent spent_in(const FrameResult& result, host::Spent here) {
  FrameSpent spent{here, {}};
  for (std::size_t i = 1; i < result.stages.size(); ++i) {  // the source comes first
    const StageReport& report = result.stages[i];
    spent.whole.processor_ms += report.worker_processor_ms;
    spent.parts.push_back({report.status, report.took});
  }
  return spent;
}

Result<std::vector<std::vector<Sample>>> measure(const Settings& settings,
                                                 std::span<Subject* const> subjects,
                                                 const Progress& progress) {
  std::vector<std::vector<Sample>> samples(subjects.size());
  const std::vector<Turn> turns = schedule(settings, subjects.size());
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const Turn& turn = turns[i];
    Subject& subject = *subjects[turn.pipeline];
    if (turn.first == 0) subject.restart();
    for (std::int64_t frame = turn.first; frame < turn.end; ++frame) {
      auto spent = subject.run(frame);
      if (!spent) return spent.error();
      if (frame < settings.warmup) continue;
      samples[turn.pipeline].push_back({turn.number, turn.repetition, frame, *std::move(spent)});
    }
    if (progress) progress(i + 1, turns.size());
  }
  return samples;
}

}  // namespace weft::bench
