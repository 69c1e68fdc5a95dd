// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <fmt/format.h>

#include "cli/shell/completion.hpp"

namespace weft::cli {
namespace {

constexpr const char* kFishHead =
    R"(# Completion of weft for fish; printed by: weft completion fish
function __weft_plugins
    weft plugins list 2>/dev/null | string match -r -g '^([a-z]+/\S+) '
end

function __weft_settings
    for word in (commandline -opc)
        if string match -q -r '\.ya?ml$' -- $word; and test -f $word
            weft check --list $word 2>/dev/null | string replace -r '^([^\t]*)\t[^\t]*' '$1='
            return
        end
    end
end

function __weft_at
    set -l at weft
    for word in (commandline -opc)[2..-1]
        switch "$at $word"
            case )";

constexpr const char* kFishEnd =
    R"(
                set at "$at $word"
        end
    end
    test "$at" = "$argv[1]"
end

)";

std::string word_of(const std::string& text) {
  std::string word = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') word += '\\';
    word += c;
  }
  return word + "'";
}

/// Possible values, as arguments of `complete`.
std::string values_of(const OptionWords& option) {
  switch (option.by) {
    case Completed::flag:
      break;
    case Completed::file:
      return " -F";
    case Completed::folder:
      return " -f -a '(__fish_complete_directories)'";
    case Completed::plugin:
      return " -f -a '(__weft_plugins)'";
    case Completed::setting:
      return " -f -a '(__weft_settings)'";
    case Completed::choice:
      return fmt::format(" -f -a '{}'", fmt::join(option.choices, " "));
  }
  return "";
}

std::string line_of(const std::string& start, const OptionWords& option) {
  std::string line = start;
  for (const std::string& name : option.names) {
    const bool is_long = name.starts_with("--");
    line += (is_long ? " -l " : " -s ") + name.substr(is_long ? 2 : 1);
  }
  if (option.by != Completed::flag) line += " -r" + values_of(option);
  return line + " -d " + word_of(option.help) + "\n";
}

}  // namespace

std::string fish_completion(const std::vector<CommandWords>& commands) {
  std::string script = kFishHead, lines;
  for (const CommandWords& command : commands) {
    if (&command != &commands.front()) script += word_of(command.path) + " ";
    const std::string start = "complete -c weft -n '__weft_at \"" + command.path + "\"'";
    for (const CommandWords* each : below(command, commands)) {
      lines += start + " -f -a " + each->name() + " -d " + word_of(each->help) + "\n";
    }
    for (const OptionWords& option : command.options) {
      lines += option.positional ? start + values_of(option) + "\n" : line_of(start, option);
    }
  }
  script.pop_back();
  return script + kFishEnd + lines;
}

}  // namespace weft::cli
