// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace weft::cli {

/// While it lives, stderr is told what ran where a component ends the process instead of answering:
/// by SIGSEGV, SIGBUS, SIGFPE, SIGILL or SIGABRT, also of a stack that ran over, or by exit() and
/// its like. After a signal the process then ends of it as it would have, after the others with
/// kComponentExited. One at a time. A stack that runs over in a thread of a component is not
/// noticed, nor what asks the kernel itself.
class SuddenEndWatch {
 public:
  SuddenEndWatch();
  ~SuddenEndWatch();
  SuddenEndWatch(const SuddenEndWatch&) = delete;
  SuddenEndWatch& operator=(const SuddenEndWatch&) = delete;
};

/// What this thread runs from now on, and whether it is a component that a run calls; of other
/// threads than those that say it, what was said last by any.
void now_running_here(const std::string& what, bool of_run);

/// _exit() for the program itself.
[[noreturn]] void end_at_once(int code);

}  // namespace weft::cli
