// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/shell/command_words.hpp"

namespace weft::cli {

// Scripts that complete commands, options, their choices, files, folders and ids of plugins. They
// call the program for the ids.
std::string bash_completion(const std::vector<CommandWords>& commands);
std::string zsh_completion(const std::vector<CommandWords>& commands);
std::string fish_completion(const std::vector<CommandWords>& commands);

}  // namespace weft::cli
