// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace weft::process {

struct Descendant {
  pid_t id = 0;
  std::string name;    ///< as the kernel has it, of at most 15 characters
  bool ended = false;  ///< and not yet waited for
};

/// The processes that a process has started, those that these have started, and so on. With `leaf`,
/// the processes below a process of this name are omitted.
std::vector<Descendant> descendants_of(pid_t process, const std::string& leaf = {});

/// Processes and threads of this machine; 0 if the kernel does not report them.
long all_tasks();

}  // namespace weft::process
