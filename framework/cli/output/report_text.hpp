// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/core.h>

#include <cstdio>

#include "cli/output/outcome.hpp"
#include "pipeline/configuration/config.hpp"

namespace weft::cli {

/// Prints the errors of files to stderr: "FILE:LINE:COLUMN: message", and "error: FILE: message" of
/// a file as a whole, as of all other files.
inline void print_report(const ConfigReport& report) {
  for (const yaml::Problem& problem : report.problems) {
    const std::string where = place_in(report.sources, problem.at);
    fmt::print(stderr, "{}{}: {}\n", problem.at.line == 0 ? "error: " : "", where, problem.message);
  }
}

}  // namespace weft::cli
