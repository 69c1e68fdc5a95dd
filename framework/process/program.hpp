// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::process {

/// How a program ended, and what it printed.
struct Answer {
  int exit_code = 0;  ///< 128 and the number of the signal that ended it
  bool late = false;  ///< it was ended, as it took too long
  std::string out, err;
};

/// Runs a program of the search path to its end. Its input is empty, its environment is this one's
/// with `settings` ("NAME=VALUE"). Processes that it leaves behind are not waited for. Up to 64 MiB
/// of its output are kept. If it takes longer than `longest`, unless that is zero, it is killed
/// with all processes that it has started. Errc::not_found if there is no such program.
Result<Answer> run_program(const std::vector<std::string>& words,
                           const std::vector<std::string>& settings = {},
                           std::chrono::milliseconds longest = {});

}  // namespace weft::process
