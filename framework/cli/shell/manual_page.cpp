// SPDX-License-Identifier: Apache-2.0
#include "cli/shell/manual_page.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>
#include <weft/core/version.hpp>

namespace weft::cli {
namespace {

/// Text in which roff sees no commands: dashes stay what can be typed.
std::string plain(const std::string& text) {
  std::string page;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool starts_line = i == 0 || text[i - 1] == '\n';
    if (starts_line && (c == '.' || c == '\'')) page += "\\&";
    if (c == '\\') {
      page += "\\e";
    } else if (c == '-') {
      page += "\\-";
    } else {
      page += c;
    }
  }
  return page;
}

std::string page_of(std::string path) {
  std::replace(path.begin(), path.end(), ' ', '-');
  return path;
}

std::string bold(const std::string& text) { return "\\fB" + plain(text) + "\\fR"; }

/// A paragraph with a hanging label.
std::string entry(const std::string& label, const std::string& text) {
  return ".TP\n" + label + "\n" + plain(text) + "\n";
}

std::string options_of(const CommandWords& command, bool positional) {
  std::string entries;
  for (const OptionWords& option : command.options) {
    if (option.positional != positional || option.inherited) continue;
    const std::string value = option.value.empty() ? "" : " " + plain(option.value);
    entries += entry(bold(option.label) + value, option.help);
  }
  return entries;
}

std::string section(const char* name, const std::string& text) {
  return text.empty() ? "" : fmt::format(".SH {}\n{}", name, text);
}

/// Text after the options: exit codes line by line, or other text.
std::string end_of(const CommandWords& command) {
  constexpr std::string_view kCodes = "Exit codes:\n";
  const bool has_codes = command.footer.starts_with(kCodes);
  const std::string rest = command.footer.substr(has_codes ? kCodes.size() : 0);
  if (rest.empty()) return "";
  return section(has_codes ? "EXIT STATUS" : "NOTES", ".nf\n" + plain(rest) + "\n.fi\n");
}

std::string see_also(const CommandWords& command) {
  const std::size_t last = command.path.rfind(' ');
  if (last == std::string::npos) return "";
  return bold(page_of(command.path.substr(0, last))) + "(1)\n";
}

}  // namespace

std::string manual_name(const CommandWords& command) { return page_of(command.path); }

std::string manual_page(const CommandWords& command, const std::vector<CommandWords>& all) {
  const std::string name = manual_name(command);
  std::string page = fmt::format(".TH \"{}\" 1 \"\" \"Weft {}\" \"Weft\"\n", plain(name), kVersion);
  page += section("NAME", plain(name) + " \\- " + plain(command.help) + "\n");
  page += section("SYNOPSIS", bold(command.path) + plain(command.usage) + "\n");
  std::string commands, group;
  for (const CommandWords* each : below(command, all)) {
    if (&command == &all.front() && each->group != group) {
      group = each->group;
      commands += ".SS " + plain(group) + "\n";
    }
    commands += entry(bold(manual_name(*each)) + "(1)", each->help);
  }
  page += section("COMMANDS", commands);
  page += section("ARGUMENTS", options_of(command, true));
  page += section("OPTIONS", options_of(command, false));
  page += end_of(command);
  return page + section("SEE ALSO", see_also(command));
}

}  // namespace weft::cli
