// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <utility>

namespace weft::host {

/// Flag that the components of an execution context are to stop. Plugins poll it during their
/// calls, from any thread.
class Cancellation {
 public:
  /// May be set from any thread.
  std::atomic<bool>& flag() { return flag_; }

  /// Also cancels while `cancelled` returns true; it is called from any thread. Null: nothing else.
  void watch(std::function<bool()> cancelled) { watched_ = std::move(cancelled); }

  bool is_requested() const { return flag_ || (watched_ && watched_()); }

 private:
  std::atomic<bool> flag_{false};
  std::function<bool()> watched_;
};

}  // namespace weft::host
