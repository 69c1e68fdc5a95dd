// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <string>

namespace weft::host {

/// So many processes may a supervised one have started that have not ended, threads not counted.
constexpr std::size_t kMostProcesses = 256;

/// [bytes] that are kept of what a supervised process prints.
constexpr off_t kKeptOutput_bytes = 64 << 10;

/// Splits this process, which must have one thread: it becomes a supervisor, and the call returns
/// in a child of it, which has a process group of its own and reads nothing.
///
/// The supervisor ends as the child ends. Before that it ends every process that the child has
/// started, in whatever session or group: it is their subreaper (see prctl(2)), so they stay below
/// it when their parents end. It does the same and ends itself on SIGTERM, when its own parent is
/// gone, and when there are more than kMostProcesses. It closes all files but the first three.
///
/// What is printed into the memory file `output`, if there is one, is kept from its end only.
/// Not ended are processes that somebody else started for the child, such as a service manager.
void go_on_supervised(int output = -1);

/// Ends a supervised process with all that it started, and waits for it. Returns its status, as
/// waitpid() gives it; -1 where it has none.
int end_supervised(pid_t supervisor);

/// Whether a status says that a process was ended with all that it started, because that was too
/// much; and how to say so: "started more than 256 processes, and was ended with them".
bool had_too_many_processes(int status);
std::string too_many_processes();

}  // namespace weft::host
