// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <weft/core/stop_check.hpp>

#include "common/workers/workers.hpp"

namespace weft {

/// How pieces of work are shared out.
struct Shares {
  int count = 0;      ///< pieces
  int at_a_time = 1;  ///< pieces that a worker takes together
  int threads = 1;    ///< at most

  int blocks() const { return (count + at_a_time - 1) / at_a_time; }
  /// Workers that take part, at least the caller's.
  int workers() const { return std::clamp(threads, 1, std::max(blocks(), 1)); }
};

/// Calls each(worker, begin, end) for blocks of the pieces [0, count). Each worker repeatedly takes
/// the first free block, so that blocks begin in order. When a call returns false or throws, all
/// workers end after their current blocks. Returns true if all is done, and throws the exception of
/// the lowest worker that threw. Throws Stopped where the call of this thread is cancelled: the
/// other workers, which may have finished all blocks, cannot check that.
template <class Each>
bool share_out(Workers& workers, const Shares& shares, Each&& each) {
  std::atomic<int> next = 0;
  std::atomic<bool> stopped = false;
  auto job = [&](int worker) {
    try {
      const int blocks = shares.blocks();
      for (int block = next++; block < blocks && !stopped; block = next++) {
        const int begin = block * shares.at_a_time;
        const int end = std::min(begin + shares.at_a_time, shares.count);
        if (!each(worker, begin, end)) stopped = true;
      }
    } catch (...) {
      stopped = true;
      throw;
    }
  };
  workers.run(shares.workers(), std::ref(job));
  ask_to_go_on();
  return !stopped;
}

}  // namespace weft
