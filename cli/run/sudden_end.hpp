// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace weft::cli {

/// While it lives, stderr is told what ran where a component ends the process instead of answering:
/// by SIGSEGV, SIGBUS, SIGFPE, SIGILL or SIGABRT, also of a stack that ran over, or by exit().
/// After a signal the process then ends of it as it would have, after exit() with kComponentExited.
/// One at a time. What calls _exit() is not noticed, nor a stack that runs over in a thread of a
/// component.
class SuddenEndWatch {
 public:
  SuddenEndWatch();
  ~SuddenEndWatch();
  SuddenEndWatch(const SuddenEndWatch&) = delete;
  SuddenEndWatch& operator=(const SuddenEndWatch&) = delete;
};

/// What this thread runs from now on; of other threads than those that say it, what was said last
/// by any.
void now_running_here(const std::string& what);

}  // namespace weft::cli
