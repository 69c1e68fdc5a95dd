// SPDX-License-Identifier: Apache-2.0
// Uses the CPU time that its parameters set in some threads, or none while it sleeps.
#include <time.h>

#include <chrono>
#include <thread>
#include <vector>

#include "idle.hpp"

namespace {

double thread_processor_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

class Busy final : public weft::Filter {
 public:
  explicit Busy(weft::Params& p) : idle_(p) {
    p.read("threads", threads_, "", {0, 16}, "that compute");
    p.read("each_ms", each_ms_, "ms", {0, 1000}, "of processor time, in each of them");
    p.read("sleep_ms", sleep_ms_, "ms", {0, 1000}, "afterwards");
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    std::vector<std::thread> threads;
    for (int i = 0; i < threads_; ++i) {
      threads.emplace_back([this] {
        const double end_ms = thread_processor_ms() + each_ms_;
        while (thread_processor_ms() < end_ms) continue;
      });
    }
    for (std::thread& thread : threads) thread.join();
    std::this_thread::sleep_for(std::chrono::milliseconds(sleep_ms_));
    return idle_.filter(in);
  }

 private:
  Idle idle_;
  int threads_ = 1, each_ms_ = 0, sleep_ms_ = 0;
};

}  // namespace

WEFT_PLUGIN(Busy, "filters/test_busy", "1.0.0", "Spends time.")
