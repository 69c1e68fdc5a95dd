// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace weft::overlay {

/// A thread that does jobs in their order. Jobs are filled in place, so that they keep their
/// memory.
template <class Job>
class JobThread {
 public:
  /// Jobs that may be unfinished at a time.
  static constexpr std::size_t kMost = 3;

  explicit JobThread(std::function<void(Job&)> work)
      : work_(std::move(work)), thread_([this] { run(); }) {}
  ~JobThread() {
    {
      const std::lock_guard lock(mutex_);
      closing_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  JobThread(const JobThread&) = delete;
  JobThread& operator=(const JobThread&) = delete;

  /// Waits until fewer than kMost jobs are unfinished, and returns a finished one to be filled.
  Job& next() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return begun_ - done_ < kMost; });
    return jobs_[begun_ % kMost];
  }

  /// Hands the job of next() over.
  void submit() {
    {
      const std::lock_guard lock(mutex_);
      ++begun_;
    }
    changed_.notify_all();
  }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return closing_ || done_ < begun_; });
      if (done_ == begun_) return;
      lock.unlock();
      work_(jobs_[done_ % kMost]);
      lock.lock();
      ++done_;
      changed_.notify_all();
    }
  }

  std::function<void(Job&)> work_;
  std::array<Job, kMost> jobs_{};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t begun_ = 0, done_ = 0;
  bool closing_ = false;
  std::thread thread_;  // the last member: it uses the others
};

}  // namespace weft::overlay
