// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace weft {

/// Thrown by worked() when the call is cancelled. Code in between lets it pass; the SDK answers the
/// call with Errc::cancelled.
struct Stopped {};

/// Who is asked whether the work of this thread goes on, for as long as this lives. The SDK has one
/// around each call of a component, so that helpers of any depth can ask without being handed a
/// call; it changes no result.
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

  /// After so many passes of an inner loop, each of some ten nanoseconds.
  static void count(std::int64_t passes) {
    if (innermost_ != nullptr && (innermost_->left_ -= passes) <= 0) innermost_->ask();
  }

  /// Passes between two questions: a millisecond or two.
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

/// Tells that so many passes of an inner loop are done, each of some ten nanoseconds, and asks the
/// host now and then whether to go on: loops that may take longer than 5 ms say so in each outer
/// pass. Costs nothing to speak of; throws Stopped when the call is cancelled. Outside of calls
/// nobody is asked.
inline void worked(std::int64_t passes = 1) { StopCheck::count(passes); }

/// The same in a loop whose pass `i` is short itself: tells so once for 1024 of them, which have so
/// many inner passes each.
inline void worked_in_loop(std::int64_t i, std::int64_t passes = 1) {
  if (i % 1024 == 0) worked(1024 * passes);
}

/// Asks at once: for passes that take a millisecond each, such as a row of a large image, and
/// before a call of a library that takes long.
inline void ask_to_go_on() { worked(StopCheck::kPassesPerAsk); }

}  // namespace weft
