// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>

namespace weft {

/// A clock that can be waited for. It decides when a frame of a source that has no clock of its own
/// is there; what a stage answers to a frame never depends on it.
class Clock {
 public:
  using Time = std::chrono::steady_clock::time_point;

  virtual ~Clock() = default;
  virtual Time now() const = 0;
  /// Returns at this time, or as soon as it is known that `stopped`, which is asked again and
  /// again; false then.
  virtual bool wait_until(Time time, const std::function<bool()>& stopped) = 0;
};

/// That of the machine.
class SteadyClock final : public Clock {
 public:
  Time now() const override;
  bool wait_until(Time time, const std::function<bool()>& stopped) override;
};

}  // namespace weft
