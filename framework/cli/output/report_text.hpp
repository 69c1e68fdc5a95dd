// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pipeline/configuration/config.hpp"

namespace weft::cli {

/// "FILE:LINE:COLUMN: message" with the line below it, see source_excerpt(), and
/// "error: FILE: message" of a file as a whole, as of all other files.
std::string problem_text(const std::vector<ConfigSource>& sources, const yaml::Problem& problem);

/// Prints the errors of files to stderr, each as problem_text().
void print_report(const ConfigReport& report);

/// Prints the warnings of files to stderr, each with its line as errors have it.
void print_warnings(const ConfigReport& report);

}  // namespace weft::cli
