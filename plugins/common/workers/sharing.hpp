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

/// Calls each(worker, begin, end) for blocks of the pieces [0, count): each worker takes the first
/// block that none has, again and again, so that blocks are begun in their order. When a call
/// answers false or throws, all end with the blocks that they have. Returns whether all was done;
/// throws what the lowest worker threw, and Stopped where the call of this thread is cancelled: the
/// other workers, which may have done it all, cannot ask.
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
