// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>

namespace weft {

/// A clock that can be waited for. It decides when a frame of a source without its own clock is
/// there; the result of a stage for a frame never depends on it.
class Clock {
 public:
  using Time = std::chrono::steady_clock::time_point;

  virtual ~Clock() = default;
  virtual Time now() const = 0;
  /// Returns at this time, or as soon as `stopped`, which is polled, returns true; false then.
  virtual bool wait_until(Time time, const std::function<bool()>& stopped) = 0;
};

/// That of the machine.
class SteadyClock final : public Clock {
 public:
  Time now() const override;
  bool wait_until(Time time, const std::function<bool()>& stopped) override;
};

}  // namespace weft
