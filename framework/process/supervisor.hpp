// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace weft::process {

/// Maximum number of running processes that a supervised process may have started, threads not
/// counted.
constexpr std::size_t kMostProcesses = 256;
constexpr int kTooManyProcesses = 97;  ///< exit code of its supervisor where there were more

/// Splits this process, which must have one thread. It becomes a supervisor, and the call returns
/// in its child, which has a separate session, no terminal and no input.
///
/// The supervisor ends as the child ends. Before that it ends every process that the child has
/// started, in any session or group. It is their subreaper (see prctl(2)), so that they stay its
/// descendants when their parents end. It does the same and ends itself on SIGTERM, when its parent
/// ends, and above kMostProcesses processes. It closes all files but the first three.
///
/// Only the end of the output in the memory file `output`, if there is one, is kept. Processes that
/// another program started for the child, such as a service manager, are not ended.
void go_on_supervised(int output = -1);

}  // namespace weft::process
