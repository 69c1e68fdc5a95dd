// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace weft::cli {

/// Completions of a word of the command line.
enum class Completed : std::uint8_t { flag, file, folder, plugin, setting, choice };

/// An option or a positional argument, as the help of its command has it.
struct OptionWords {
  std::vector<std::string> names;  ///< "-h", "--help", or one without dashes
  std::string label, value, help;  ///< "--out", "FOLDER" and its description
  Completed by = Completed::flag;
  std::vector<std::string> choices;
  bool positional = false;
  bool inherited = false;  ///< it is the program's, taken by all commands
};

/// A command, or the program itself.
struct CommandWords {
  std::string path;   ///< "weft plugins show"
  std::string group;  ///< its heading in the help of the program
  std::string help, usage, footer;
  std::vector<OptionWords> options;
  std::vector<std::string> commands;  ///< names of those below it

  std::string name() const { return path.substr(path.rfind(' ') + 1); }
  /// Its first argument without a name, or null.
  const OptionWords* positional() const;
};

/// The program and all its commands, each before those below it.
std::vector<CommandWords> command_words(const CLI::App& program);

/// Those right below a command, in the order of its help.
std::vector<const CommandWords*> below(const CommandWords& command,
                                       const std::vector<CommandWords>& all);

}  // namespace weft::cli
