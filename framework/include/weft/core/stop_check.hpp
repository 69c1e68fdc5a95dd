// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace weft {

/// Thrown by worked() when the call is cancelled. Intermediate code lets it pass; the SDK returns
/// Errc::cancelled from the call.
struct Stopped {};

/// Connects worked() of this thread to a cancellation check for the lifetime of the object. The SDK
/// creates one around each call of a component, so that nested functions can check without a Call.
/// It does not change any result.
class StopCheck {
 public:
  using Cancelled = bool (*)(const void* whom);

  StopCheck(Cancelled cancelled, const void* whom)
      : cancelled_(cancelled), whom_(whom), outer_(innermost_) {
    innermost_ = this;
  }
  ~StopCheck() { innermost_ = outer_; }
  StopCheck(const StopCheck&) = delete;
  StopCheck& operator=(const StopCheck&) = delete;

  /// Counts passes of an inner loop, each of about ten nanoseconds.
  static void count(std::int64_t passes) {
    if (innermost_ != nullptr && (innermost_->left_ -= passes) <= 0) innermost_->ask();
  }

  /// Passes between two cancellation checks; about one to two milliseconds.
  static constexpr std::int64_t kPassesPerAsk = 100'000;

 private:
  void ask() {
    left_ = kPassesPerAsk;
    if (cancelled_(whom_)) throw Stopped{};
  }

  Cancelled cancelled_;
  const void* whom_;
  StopCheck* outer_;
  std::int64_t left_ = kPassesPerAsk;

  static inline constinit thread_local StopCheck* innermost_ = nullptr;
};

/// Counts passes of an inner loop, each of about ten nanoseconds, and regularly checks for
/// cancellation. Loops that may take longer than 5 ms call it in each outer pass. The cost is
/// negligible. Throws Stopped when the call is cancelled. Outside of calls it does nothing.
inline void worked(std::int64_t passes = 1) { StopCheck::count(passes); }

/// Calls worked() once per 1024 short passes of a loop with index `i`. Each pass stands for
/// `passes` inner passes.
inline void worked_in_loop(std::int64_t i, std::int64_t passes = 1) {
  if (i % 1024 == 0) worked(1024 * passes);
}

/// Checks for cancellation immediately. Use it for passes of about a millisecond, such as a row of
/// a large image, and before long library calls.
inline void ask_to_go_on() { worked(StopCheck::kPassesPerAsk); }

}  // namespace weft
