// SPDX-License-Identifier: Apache-2.0
#include "common/workers/workers.hpp"

#include <algorithm>
#include <weft/core/index.hpp>

namespace weft {

Workers::~Workers() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  begun_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void Workers::run(int count, const Job& job) {
  if (count <= 1) return job(0);
  {
    const std::lock_guard lock(mutex_);
    errors_.assign(to_index(count), nullptr);
    while (static_cast<int>(threads_.size()) < count - 1) {
      const int worker = static_cast<int>(threads_.size()) + 1;
      threads_.emplace_back([this, worker] { work(worker); });
    }
    job_ = &job;
    count_ = count;
    running_ = count - 1;
    ++round_;
  }
  begun_.notify_all();
  call(0);
  std::unique_lock lock(mutex_);
  done_.wait(lock, [&] { return running_ == 0; });
  const auto thrown =
      std::find_if(errors_.begin(), errors_.end(),
                   [](const std::exception_ptr& error) { return error != nullptr; });
  if (thrown != errors_.end()) std::rethrow_exception(*thrown);
}

void Workers::call(int worker) {
  try {
    (*job_)(worker);
  } catch (...) {
    errors_[to_index(worker)] = std::current_exception();
  }
}

void Workers::work(int worker) {
  std::uint64_t seen = 0;
  std::unique_lock lock(mutex_);
  while (true) {
    // A thread that the present run does not need waits for the next.
    begun_.wait(lock, [&] { return closing_ || (round_ != seen && worker < count_); });
    if (closing_) return;
    seen = round_;
    lock.unlock();
    call(worker);
    lock.lock();
    if (--running_ == 0) done_.notify_one();
  }
}

}  // namespace weft
