// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "host/loading/component_checks.hpp"

namespace weft::cli {

/// The exit code of a process that a second SIGINT ended; that of SIGTERM is 143.
inline constexpr int kInterruptedTwice = 130;

/// From now on the first SIGINT or SIGTERM sets this flag instead of ending the process. The second
/// one ends it at once, with exit code 128 and the number of the signal, and prints on stderr what
/// every thread runs.
const std::atomic<bool>& watch_for_interruption();

/// Sets the action of this thread that is reported on a second interrupt, or if a component ends
/// the process: "the plan is read".
void now_running(const std::string& what);

/// The same, of what a component does in a frame, by the thread that calls it, until set_ended();
/// before the first frame and after the last one host::kOfflineFrame.
void now_running(const std::string& stage, const std::string& component, const std::string& what,
                 std::uint64_t frame);

/// The checks of a file; the component that is being checked is reported as the current action.
host::ComponentChecks checks_of(const std::string& file);

}  // namespace weft::cli
