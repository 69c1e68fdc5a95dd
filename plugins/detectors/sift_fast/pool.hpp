// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace weft::sift_fast {

/// Threads that live as long as this does, and wait in between.
class Pool {
 public:
  Pool() = default;
  ~Pool();
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  /// Starts more if there are fewer.
  void grow(int threads);

  /// Calls `work(worker)` on `threads` threads at once, workers 0 to threads - 1; 0 is the calling
  /// thread. Returns when all have returned; throws what one of them threw, worker 0 first. The
  /// others must come to an end when one has thrown.
  template <class Work>
  void run(int threads, Work& work) {
    run(
        threads, [](void* whose, int worker) { (*static_cast<Work*>(whose))(worker); }, &work);
  }

 private:
  using Call = void (*)(void* whose, int worker);
  void run(int threads, Call call, void* whose);
  void serve(int worker, std::uint32_t round);

  std::vector<std::thread> threads_;
  std::atomic<std::uint32_t> round_{0};  ///< counts runs
  std::atomic<int> at_work_{0};
  bool is_over_ = false;
  int wanted_ = 0;
  Call call_ = nullptr;
  void* whose_ = nullptr;
  std::mutex failure_mutex_;
  std::exception_ptr failure_;
};

}  // namespace weft::sift_fast
