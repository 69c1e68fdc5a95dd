// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <weft/core/result.hpp>

namespace weft::host {

/// The result of `find_out` in a copy of this process, in which it may crash, end the process, hang
/// or print to stdout. Fails with incompatible, without a position, if no answer came: "ends the
/// process that loads it by signal 11 (Segmentation fault)". Fails with io if no process can be
/// started. A copy that takes longer than `longest` is killed, together with the processes that it
/// started. The calling program must have no other threads: a copy has neither these threads nor a
/// way to release their locks.
Result<std::string> ask_in_child(const std::function<Result<std::string>()>& find_out,
                                 std::chrono::milliseconds longest);

}  // namespace weft::host
