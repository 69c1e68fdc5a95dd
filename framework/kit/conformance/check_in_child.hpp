// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "kit/conformance/notebook.hpp"

namespace weft::conformance {

/// When a check of the processes that this one has started takes too long: in CPU time, or without
/// any use of a CPU. A process that waits for a CPU on a busy machine gets a part of it, one that
/// sleeps does not.
class Deadline {
 public:
  explicit Deadline(std::chrono::seconds longest) : longest_(longest) {}
  /// `written` is a notebook. Each note in it begins a new check.
  bool is_over(const std::string& written);

 private:
  using Clock = std::chrono::steady_clock;
  std::chrono::seconds longest_;
  std::size_t size_ = 0;
  Clock::time_point begun_ = Clock::now(), looked_ = begun_;
  Clock::time_point window_ = begun_;  ///< when its use of CPUs was compared last
  double window_used_ms_ = 0.0;        ///< CPU time of the check until then
};

/// Makes checks in a separate process, a copy of this one, which must have one thread. A crash, an
/// exit or a check that takes more than `longest` of CPU time is a failure of the current check, or
/// of `first` before any check began. A process that waits for that long without computing is ended
/// too. The checks after it are not made. The output of the process is discarded, except the last
/// line before it was ended.
std::vector<Finding> check_in_child(const std::string& first, const Choice& choice,
                                    std::chrono::seconds longest,
                                    const std::function<void(Notebook&)>& make);

/// Explains the end of this process, if the current check does not return: called by checks that
/// see a cause. For signal handlers.
void remark_on_end(const char* text);

}  // namespace weft::conformance
