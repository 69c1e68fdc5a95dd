// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <fmt/format.h>

#include <weft/core/shell_word.hpp>

#include "cli/shell/completion.hpp"

namespace weft::cli {
namespace {

constexpr const char* kZshHead =
    R"zsh(#compdef weft
# Completion of weft for zsh; printed by: weft completion zsh
_weft_plugins() {
  compadd -- ${(f)"$(weft plugins list 2>/dev/null | sed -n 's|^\([a-z]*/[^ ]*\) .*|\1|p')"}
}

_weft_settings() {
  local word
  local -a settings
  for word in "${(@)words}"; do
    [[ $word == *.y(a|)ml && -f $word ]] || continue
    settings=(${(f)"$(weft check --list "$word" 2>/dev/null | awk -F '\t' '{print $1 ":" $3}')"})
    _describe setting settings -S =
    return
  done
}

_weft() {
  local at=weft word
  local -a commands options
  for word in "${(@)words[2,CURRENT-1]}"; do
    case "$at $word" in
)zsh";

constexpr const char* kZshEnd =
    R"zsh(  esac
  if [[ ${words[CURRENT]} == -* ]]; then
    _describe option options
  elif (( $#commands )); then
    _describe command commands
  else
    eval "$action"
  fi
}

if [[ ${funcstack[1]} == _weft ]]; then _weft "$@"; else compdef _weft weft; fi
)zsh";

/// Possible values, as a command.
std::string command_for(const OptionWords& option) {
  switch (option.by) {
    case Completed::flag:
      break;
    case Completed::file:
      return "_files";
    case Completed::folder:
      return "_files -/";
    case Completed::plugin:
      return "_weft_plugins";
    case Completed::setting:
      return "_weft_settings";
    case Completed::choice:
      return fmt::format("compadd -- {}", fmt::join(option.choices, " "));
  }
  return "";
}

/// 'NAME:what it is', as _describe takes it.
std::string described(std::string name, const std::string& help) {
  for (std::size_t at = name.find(':'); at != std::string::npos; at = name.find(':', at + 2)) {
    name.insert(at, "\\");
  }
  return shell_word(name + ":" + help);
}

}  // namespace

std::string zsh_completion(const std::vector<CommandWords>& commands) {
  std::string script = kZshHead, values, words;
  std::vector<std::string> paths;
  for (const CommandWords& command : commands) {
    if (&command != &commands.front()) paths.push_back(shell_word(command.path));
    std::vector<std::string> names, options;
    for (const CommandWords* each : below(command, commands)) {
      names.push_back(described(each->name(), each->help));
    }
    for (const OptionWords& option : command.options) {
      if (option.positional) continue;
      for (const std::string& name : option.names) {
        options.push_back(described(name, option.help));
        if (option.by == Completed::flag) continue;
        values += fmt::format("    ({}) {}; return ;;\n", shell_word(command.path + " " + name),
                              command_for(option));
      }
    }
    const OptionWords* positional = command.positional();
    words += fmt::format("    ({})\n      commands=({})\n      options=({})\n      action={} ;;\n",
                         shell_word(command.path), fmt::join(names, " "), fmt::join(options, " "),
                         shell_word(positional != nullptr ? command_for(*positional) : ""));
  }
  script += fmt::format("      ({}) at+=\" $word\" ;;\n    esac\n  done\n", fmt::join(paths, "|"));
  script += "  case \"$at ${words[CURRENT-1]}\" in\n" + values + "  esac\n";
  return script + "  local action\n  case $at in\n" + words + kZshEnd;
}

}  // namespace weft::cli
