// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace weft::cli {

/// The action of a thread, in a form that signal handlers can read.
struct RunningCall {
  std::array<char, 256> bytes;
  std::size_t length;
  bool of_run;  ///< a component that a run calls
};

/// Sets the current action of this thread, and if it is a component that a run calls.
void set_running(const std::string& what, bool of_run);

/// The current action of this thread has ended. It stays its last one.
void set_ended();

// Signal handlers can call the rest.

/// The last action of this thread, or null.
const RunningCall* last_call_here();

/// The last action of any thread, or null.
const RunningCall* last_call_anywhere();

/// Visits the current action of every thread that has one, and returns their number. More than 64
/// threads at a time are not known.
int visit_running_calls(void (*visit)(const RunningCall&));

}  // namespace weft::cli
