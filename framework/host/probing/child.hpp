// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <weft/core/result.hpp>

namespace weft::host {

/// What `find_out` returns in a copy of this process, which may do there what it likes: crash, end
/// the process, hang, print to stdout. Fails with incompatible, without a place, where no answer
/// came: "ends the process that loads it by signal 11 (Segmentation fault)"; with io where there
/// can be no other process. A copy that takes longer than `longest` is killed, and what it started
/// with it. Not for programs that have threads already: those are not copied, nor the locks that
/// they hold given back.
Result<std::string> ask_in_child(const std::function<Result<std::string>()>& find_out,
                                 std::chrono::milliseconds longest);

}  // namespace weft::host
