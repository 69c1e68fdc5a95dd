// SPDX-License-Identifier: Apache-2.0
#include "cli/shell/wrong_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>
#include <weft/core/quote.hpp>
#include <weft/core/suggest.hpp>

#include "cli/output/outcome.hpp"
#include "cli/shell/coloured_help.hpp"

namespace weft::cli {
namespace {

/// The command that was given, as it is typed: "weft data convert".
struct Given {
  const CLI::App* command;
  std::string path;
};

Given given_command(const CLI::App& program, const std::string& name) {
  Given given{&program, name};
  while (!given.command->get_subcommands().empty()) {
    given.command = given.command->get_subcommands().front();
    given.path += " " + given.command->get_name();
  }
  return given;
}

std::vector<std::string> names_of_commands(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* each : command.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(each->get_name());
  }
  return names;
}

/// "--set" of all that the command takes.
std::vector<std::string> names_of_options(const CLI::App* command) {
  std::vector<std::string> names;
  for (; command != nullptr; command = command->get_parent()) {
    for (const CLI::Option* option : command->get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
  }
  return names;
}

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string unknown_option(const Given& given, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  const std::vector<std::string> known = names_of_options(given.command);
  // Before the name of its command an option is nothing that is known there.
  if (has(known, name)) {
    return fmt::format("give {} behind '{}'", name, given.path);
  }
  return fmt::format("{} has no option {}{}", given.path, quote(name), did_you_mean(name, known));
}

/// A word that stands where none is expected.
std::string unexpected(const Given& given, const std::string& word) {
  const std::vector<std::string> commands = names_of_commands(*given.command);
  if (!commands.empty()) {
    const std::string all = fmt::format("; there are: {}", fmt::join(commands, ", "));
    if (word == "help")
      return fmt::format("no command 'help'; did you mean {} --help?", given.path);
    return fmt::format("no command '{}'{}", word, did_you_mean(word, commands, all));
  }
  const bool is_setting =
      word.find('=') != std::string::npos && has(names_of_options(given.command), "--set");
  return fmt::format("{} does not expect {}{}", given.path, quote(word),
                     is_setting ? "; did you mean --set " + quote(word) + "?" : "");
}

const CLI::Option* option_of(const Given& given, std::string_view text) {
  const std::string name(text.substr(0, text.find(':')));
  for (const CLI::App* app = given.command; app != nullptr; app = app->get_parent()) {
    for (const CLI::Option* option : app->get_options()) {
      if (option->check_name(name)) return option;
    }
  }
  return nullptr;
}

/// Rewords CLI11's messages about values in the style of this program.
std::string of_values(const Given& given, const CLI::ParseError& error) {
  std::string text = error.what();
  const CLI::Option* option = option_of(given, text);
  if (option != nullptr && dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
    const std::string name = option->get_name(option->get_positional());
    const int count = option->get_expected_min();
    if (option->get_expected_max() == 0) return name + " takes no value";
    const std::string& value = option->get_option_text();
    return fmt::format("{} needs {}: {}", name,
                       count == 1 ? "a value" : fmt::format("{} values", count),
                       value.empty() ? option->get_description() : value);
  }
  struct Saying {
    std::string library, ours;
  };
  for (const Saying& saying :
       {Saying{"Could not convert: ", "a value that the option does not take: "},
        Saying{" excludes ", " cannot be given with "}, Saying{" requires ", " needs "}}) {
    const std::size_t at = text.find(saying.library);
    if (at == std::string::npos) continue;
    return text.substr(0, at) + saying.ours + text.substr(at + saying.library.size());
  }
  return text;
}

std::string sentence(const CLI::App& program, const Given& given, const CLI::ParseError& error) {
  const std::vector<std::string> left = program.remaining(true);
  const auto option = std::find_if(left.begin(), left.end(), [](const std::string& word) {
    return word.starts_with("-") && word != "--";
  });
  if (option != left.end()) return unknown_option(given, *option);
  const bool is_group = !names_of_commands(*given.command).empty();
  const bool is_extra = is_group || dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  return is_extra && !left.empty() ? unexpected(given, left.front()) : of_values(given, error);
}

}  // namespace

void print_wrong_words(const CLI::App& program, const std::string& name,
                       const CLI::ParseError& error) {
  const Given given = given_command(program, name);
  const bool is_group = !names_of_commands(*given.command).empty();
  const bool lacks_command = std::string_view(error.what()).starts_with("A subcommand");
  if (lacks_command && program.remaining(true).empty()) {
    const std::size_t last = given.path.rfind(' ');  // help() adds the name of the command
    const bool is_below = given.command != &program;
    const std::string help = given.command->help(is_below ? given.path.substr(0, last) : "");
    fmt::print(stderr, "{}\n", coloured_help(help, colours_of(stderr)));
    print_error({Errc::invalid_value, fmt::format("give {} a command", given.path), {}});
    return;
  }
  std::string text = sentence(program, given, error);
  if (!is_group && !text.ends_with("?")) text += fmt::format("; see: {} --help", given.path);
  print_error({Errc::invalid_value, std::move(text), {}});
}

}  // namespace weft::cli
