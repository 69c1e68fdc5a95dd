// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/clock.hpp"

#include <algorithm>
#include <thread>

namespace weft {

Clock::Time SteadyClock::now() const { return std::chrono::steady_clock::now(); }

bool SteadyClock::wait_until(Time time, const std::function<bool()>& stopped) {
  constexpr std::chrono::milliseconds kAskEvery{5};
  while (!stopped()) {
    const Time at = now();
    if (at >= time) return true;
    std::this_thread::sleep_until(std::min(time, at + kAskEvery));
  }
  return false;
}

}  // namespace weft
