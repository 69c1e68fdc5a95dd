// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <mutex>

namespace weft::host {

/// Divides a number of threads between callers that may call at the same time. From any thread.
class ThreadShares {
 public:
  /// The threads of a call while it lasts.
  class Loan {
   public:
    explicit Loan(ThreadShares& from) : from_(from), threads_(from.take()) {}
    ~Loan() { from_.give_back(threads_); }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;

    int threads() const { return threads_; }

   private:
    ThreadShares& from_;
    int threads_;
  };

  void divide(int threads, int callers) {
    const std::lock_guard lock(mutex_);
    free_ = std::max(threads, 1);
    equal_ = std::max(threads / std::max(callers, 1), 1);
  }

  /// Share of a caller if all call at the same time.
  int equal() const { return equal_; }

 private:
  /// All that no other call has, at least an equal share: the others need not use all of theirs.
  int take() {
    const std::lock_guard lock(mutex_);
    const int threads = std::max(free_, equal_);
    free_ -= threads;
    return threads;
  }
  void give_back(int threads) {
    const std::lock_guard lock(mutex_);
    free_ += threads;
  }

  std::mutex mutex_;
  int free_ = 1;  ///< threads without a call; negative while callers have more than there are
  int equal_ = 1;
};

}  // namespace weft::host
