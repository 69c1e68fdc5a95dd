// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace weft::cli {

/// What is wrong with a command line that CLI11 refuses, in one sentence with what to do: an option
/// that the command does not have is named before what is missing because of it.
std::string wrong_words(const CLI::App& program, const CLI::ParseError& error);

/// Whether a command was left out of "weft" or "weft data": then its help lists them.
const CLI::App* without_command(const CLI::App& program);

}  // namespace weft::cli
