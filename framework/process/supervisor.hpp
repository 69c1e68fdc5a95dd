// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace weft::process {

/// So many processes may a supervised one have started that have not ended, threads not counted.
constexpr std::size_t kMostProcesses = 256;
constexpr int kTooManyProcesses = 97;  ///< exit code of its supervisor where there were more

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

}  // namespace weft::process
