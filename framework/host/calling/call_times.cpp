// SPDX-License-Identifier: Apache-2.0
#include "host/calling/call_times.hpp"

#include <iterator>

namespace weft::host {

void CallTimes::note(Timing timing) {
  const std::lock_guard lock(mutex_);
  const auto of_frame = timings_.try_emplace(timing.frame, memory_).first;
  of_frame->second.push_back(std::move(timing));
}

Timings CallTimes::take() {
  const std::lock_guard lock(mutex_);
  Timings taken(memory_);
  for (auto& [frame, timings] : std::exchange(timings_, ByFrame(memory_))) {
    taken.insert(taken.end(), std::make_move_iterator(timings.begin()),
                 std::make_move_iterator(timings.end()));
  }
  return taken;
}

Timings CallTimes::take(std::uint64_t frame) {
  const std::lock_guard lock(mutex_);
  const auto found = timings_.find(frame);
  if (found == timings_.end()) return Timings(memory_);
  Timings taken = std::move(found->second);
  timings_.erase(found);
  return taken;
}

}  // namespace weft::host
