// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace weft::cli {

/// The option --set of commands that take a pipeline.
void add_settings(CLI::App& command, std::vector<std::string>& settings);

/// The option --without of commands that take a plan.
void add_without(CLI::App& command, std::vector<std::string>& names);

/// The run folder of a pipeline for which none is given: runs/<pipeline>, or the first of
/// runs/<pipeline>-2, -3 ... that does not exist.
std::string free_folder(const std::string& pipeline);

}  // namespace weft::cli
