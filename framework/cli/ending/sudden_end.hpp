// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace weft::cli {

/// While it lives, stderr reports the last action of the thread if a component ends the process
/// instead of answering. For a thread of a component it reports the library. It detects
/// SIGSEGV, SIGBUS, SIGFPE, SIGILL and SIGABRT, also after a stack overflow, and exit() and similar
/// functions. After a signal the process then ends as it would have, otherwise with
/// kComponentExited. One at a time. It detects neither a stack overflow in a component's thread nor
/// direct system calls.
class SuddenEndWatch {
 public:
  SuddenEndWatch();
  ~SuddenEndWatch();
  SuddenEndWatch(const SuddenEndWatch&) = delete;
  SuddenEndWatch& operator=(const SuddenEndWatch&) = delete;
};

/// From now on, a stack overflow of this thread is detected, too.
void watch_stack_here();

/// Prints on stderr. Signal handlers can call these.
void say(const char* text, std::size_t length);
void say(const char* text);

/// _exit() for the program itself.
[[noreturn]] void end_at_once(int code);

}  // namespace weft::cli
