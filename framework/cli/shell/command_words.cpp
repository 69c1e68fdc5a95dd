// SPDX-License-Identifier: Apache-2.0
#include "cli/shell/command_words.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

namespace weft::cli {
namespace {

/// "a", "b" of a type "TEXT:{a,b}", which CLI11 gives an option with a list of choices.
std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.find('}');
  std::vector<std::string> choices;
  if (open == std::string::npos || close == std::string::npos) return choices;
  std::istringstream list(type.substr(open + 1, close - open - 1));
  for (std::string choice; std::getline(list, choice, ',');) choices.push_back(choice);
  return choices;
}

/// The placeholders of values in the program's help determine their kind.
Completed completed_by(const OptionWords& option) {
  if (!option.choices.empty()) return Completed::choice;
  const std::string& text = option.positional ? option.names.front() : option.value;
  const std::string word = text.substr(0, text.find(' '));
  for (const char* folder : {"DIR", "FOLDER", "RUN"}) {
    if (word == folder) return Completed::folder;
  }
  if (word.starts_with("PATH=VALUE")) return Completed::setting;
  return word == "ID" || word == "ID_OR_FILE" ? Completed::plugin : Completed::file;
}

OptionWords words_of(const CLI::Option& option) {
  const CLI::Formatter formatter{};
  OptionWords words;
  words.positional = option.get_positional();
  for (const std::string& name : option.get_snames()) words.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) words.names.push_back("--" + name);
  if (words.positional) words.names = {option.get_name(true)};
  words.label = formatter.make_option_name(&option, words.positional);
  words.value = formatter.make_option_opts(&option);
  words.value.erase(0, words.value.find_first_not_of(' '));
  words.help = option.get_description();
  words.choices = choices_of(option);
  if (option.get_expected_max() > 0) words.by = completed_by(words);
  return words;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_name().empty(); });
}

/// Adds a command, with options that it takes from the program.
void add(const CLI::App& app, const std::string& path, const std::vector<OptionWords>& inherited,
         std::vector<CommandWords>& all) {
  CommandWords words;
  words.path = path;
  words.group = app.get_group();
  words.help = app.get_description();
  words.footer = app.get_footer();
  words.usage = CLI::Formatter().make_usage(&app, path);
  words.usage.erase(0, words.usage.find(path) + path.size());
  words.usage.erase(words.usage.find_last_not_of('\n') + 1);
  for (const CLI::Option* option : app.get_options()) words.options.push_back(words_of(*option));
  words.options.insert(words.options.end(), inherited.begin(), inherited.end());
  for (const CLI::App* command : commands_of(app)) words.commands.push_back(command->get_name());
  all.push_back(std::move(words));
}

void add_below(const CLI::App& app, const std::string& path,
               const std::vector<OptionWords>& inherited, std::vector<CommandWords>& all) {
  for (const CLI::App* command : commands_of(app)) {
    const std::string name = path + " " + command->get_name();
    add(*command, name, inherited, all);
    add_below(*command, name, inherited, all);
  }
}

}  // namespace

const OptionWords* CommandWords::positional() const {
  const auto found = std::find_if(options.begin(), options.end(),
                                  [](const OptionWords& option) { return option.positional; });
  return found != options.end() ? &*found : nullptr;
}

std::vector<CommandWords> command_words(const CLI::App& program) {
  std::vector<OptionWords> inherited;
  for (const CLI::Option* option : program.get_options()) {
    OptionWords words = words_of(*option);
    words.inherited = true;
    if (words.by != Completed::flag) inherited.push_back(std::move(words));
  }
  std::vector<CommandWords> all;
  add(program, "weft", {}, all);
  add_below(program, "weft", inherited, all);
  return all;
}

std::vector<const CommandWords*> below(const CommandWords& command,
                                       const std::vector<CommandWords>& all) {
  std::vector<const CommandWords*> found;
  for (const CommandWords& each : all) {
    const std::size_t last = each.path.rfind(' ');
    if (last != std::string::npos && each.path.substr(0, last) == command.path) {
      found.push_back(&each);
    }
  }
  return found;
}

}  // namespace weft::cli
