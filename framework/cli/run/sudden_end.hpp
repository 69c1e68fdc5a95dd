// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace weft::cli {

/// While it lives, stderr reports the current action if a component ends the process instead of
/// answering. It detects SIGSEGV, SIGBUS, SIGFPE, SIGILL and SIGABRT, also after a stack overflow,
/// and exit() and similar functions. After a signal the process then ends as it would have,
/// otherwise with kComponentExited. One at a time. It detects neither a stack overflow in a
/// component's thread nor direct system calls.
class SuddenEndWatch {
 public:
  SuddenEndWatch();
  ~SuddenEndWatch();
  SuddenEndWatch(const SuddenEndWatch&) = delete;
  SuddenEndWatch& operator=(const SuddenEndWatch&) = delete;
};

/// Sets the current action of this thread, and if it is a component that a run calls. For threads
/// that never set an action, the last action of any thread is reported.
void now_running_here(const std::string& what, bool of_run);

/// _exit() for the program itself.
[[noreturn]] void end_at_once(int code);

}  // namespace weft::cli
