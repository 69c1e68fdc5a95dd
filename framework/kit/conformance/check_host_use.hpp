// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kit/conformance/notebook.hpp"
#include "kit/conformance/play.hpp"

/// How a component uses the host that calls it, and what it leaves to the end of the process.
namespace weft::conformance {

/// Faults where the structs of a call are written, or used once it has returned.
void check_structs(Play& play);

/// Checks its texts for the log.
void check_log(Play& play, Page& page);

/// Checks that it invokes only what it was given.
void check_invocations(Play& play, Page& page);

/// Checks that a process that has used it ends by exit(), soon and without a word.
void check_exit(Play& play, Page& page);

}  // namespace weft::conformance
