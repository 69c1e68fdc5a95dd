// SPDX-License-Identifier: Apache-2.0
#include "pool.hpp"

namespace weft::sift_fast {

Pool::~Pool() {
  is_over_ = true;
  ++round_;
  round_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void Pool::grow(int threads) {
  for (auto worker = static_cast<int>(threads_.size()) + 1; worker < threads; ++worker) {
    threads_.emplace_back([this, worker, round = round_.load()] { serve(worker, round); });
  }
}

void Pool::run(int threads, Call call, void* whose) {
  if (threads <= 1) {
    call(whose, 0);
    return;
  }
  grow(threads);
  call_ = call;
  whose_ = whose;
  wanted_ = threads;
  at_work_ = static_cast<int>(threads_.size());
  ++round_;
  round_.notify_all();
  std::exception_ptr own;
  try {
    call(whose, 0);
  } catch (...) {
    own = std::current_exception();
  }
  for (int left = at_work_; left != 0; left = at_work_) at_work_.wait(left);
  const std::exception_ptr other = failure_;
  failure_ = nullptr;
  if (own) std::rethrow_exception(own);
  if (other) std::rethrow_exception(other);
}

void Pool::serve(int worker, std::uint32_t round) {
  for (;;) {
    round_.wait(round);
    ++round;
    if (is_over_) return;
    if (worker < wanted_) {
      try {
        call_(whose_, worker);
      } catch (...) {
        const std::lock_guard lock(failure_mutex_);
        failure_ = std::current_exception();
      }
    }
    if (--at_work_ == 0) at_work_.notify_one();
  }
}

}  // namespace weft::sift_fast
