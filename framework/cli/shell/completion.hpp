// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/shell/command_words.hpp"

namespace weft::cli {

// Scripts that complete commands, options, their choices, files, folders, ids of plugins, and the
// paths of settings of the pipeline that the command line names. They call the program for ids and
// paths.
std::string bash_completion(const std::vector<CommandWords>& commands);
std::string zsh_completion(const std::vector<CommandWords>& commands);
std::string fish_completion(const std::vector<CommandWords>& commands);

}  // namespace weft::cli
