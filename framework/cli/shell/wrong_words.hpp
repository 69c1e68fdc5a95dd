// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace weft::cli {

/// Prints to stderr what is wrong with a command line that CLI11 refuses, and what to do. An option
/// that the command does not have is named before what is missing because of it. Where a command is
/// missing, as in "weft" and "weft data", the help is printed that lists them. `name` is how the
/// program is started.
void print_wrong_words(const CLI::App& program, const std::string& name,
                       const CLI::ParseError& error);

}  // namespace weft::cli
