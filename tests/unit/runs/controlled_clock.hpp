// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <mutex>

#include "pipeline/runs/clock.hpp"

namespace weft {

/// A clock that stands still until a test puts it forward. One thread waits for it.
class ControlledClock final : public Clock {
 public:
  Time now() const override {
    const std::lock_guard lock(mutex_);
    return now_;
  }

  bool wait_until(Time time, const std::function<bool()>& stopped) override {
    std::unique_lock lock(mutex_);
    awaited_ = time;
    changed_.notify_all();
    while (now_ < time) {
      changed_.wait_for(lock, std::chrono::milliseconds(1));
      lock.unlock();
      const bool stops = stopped();
      lock.lock();
      if (stops) return false;
    }
    return true;
  }

  /// Returns when a thread waits for a later time: all that was due is done. False when that takes
  /// a minute.
  bool put_forward(std::chrono::milliseconds by) {
    std::unique_lock lock(mutex_);
    now_ += by;
    changed_.notify_all();
    return changed_.wait_for(lock, std::chrono::minutes(1), [&] { return awaited_ > now_; });
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Time now_{}, awaited_{};
};

}  // namespace weft
