// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <cstdint>
#include <string>
#include <weft/core/quote.hpp>
#include <weft/core/rng.hpp>
#include <weft/core/stop_check.hpp>

namespace weft {

/// The context of one call of a component. Valid until the call returns.
class Call {
 public:
  explicit Call(const weft_call& raw) : raw_(&raw) {}

  /// Index of the frame, from 0; 2^64-1 in offline calls.
  std::uint64_t frame() const { return raw_->frame; }
  /// Seed of this component in this frame, independent of the order and the machine of execution.
  std::uint64_t seed() const { return raw_->seed; }
  Rng rng() const { return Rng(raw_->seed); }
  /// Maximum number of threads that the component may use.
  int threads() const { return raw_->threads; }
  /// Returns whether to stop. Check at least every 5 ms, then return an Error with Errc::cancelled.
  /// Loops may call weft::worked() instead, which checks for them.
  bool cancelled() const { return raw_->host->cancelled(raw_) != 0; }
  /// Connects weft::worked() to the host's cancellation for the lifetime of the result.
  StopCheck stop_check() const {
    return {[](const void* whom) {
              const auto* asked = static_cast<const weft_call*>(whom);
              return asked->host->cancelled(asked) != 0;
            },
            raw_};
  }
  void log_info(const std::string& text) const {
    raw_->host->log(raw_, 1, without_nul(text).c_str());
  }
  void log_warning(const std::string& text) const {
    raw_->host->log(raw_, 2, without_nul(text).c_str());
  }

  const weft_call& raw() const { return *raw_; }

 private:
  const weft_call* raw_;
};

}  // namespace weft
