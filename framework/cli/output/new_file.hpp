// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <weft/core/result.hpp>

namespace weft::cli {

/// Adds --overwrite to a command that writes a file of the caller's choice.
void add_overwrite(CLI::App& command, bool& overwrite);

/// Fails where something is at `file`, unless it may be overwritten; devices and pipes take what
/// they are given.
Result<void> check_new_file(const std::string& file, bool overwrite);

/// Makes the folder that --out names; fails where something is at it that is no empty folder.
Result<void> make_new_folder(const std::string& folder);

}  // namespace weft::cli
