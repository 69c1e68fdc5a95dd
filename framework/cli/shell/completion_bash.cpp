// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <fmt/format.h>

#include <weft/core/shell_word.hpp>

#include "cli/shell/completion.hpp"

namespace weft::cli {
namespace {

constexpr const char* kBashHead =
    R"(# Completion of weft for bash; printed by: weft completion bash
_weft_plugins() {
  weft plugins list 2>/dev/null | sed -n 's|^\([a-z]*/[^ ]*\) .*|\1|p'
}

_weft_settings() {
  local word
  for word in "${COMP_WORDS[@]}"; do
    [[ $word == *.y?(a)ml && -f $word ]] || continue
    weft check --list "$word" 2>/dev/null | sed 's|\t.*|=|'
    return
  done
}

_weft() {
  local at=weft words='' options='' action='' i
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; i++)); do
    case "$at ${COMP_WORDS[i]}" in
)";

constexpr const char* kBashEnd =
    R"(      esac
      [[ $current == -* ]] && words=$options action=''
      ;;
  esac
  if [[ -n $action || -z $words ]]; then
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen "${action:--f}" -- "$current")
  else
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  fi
}

complete -F _weft weft
)";

/// Possible values, as assignments.
std::string assignments_of(const OptionWords& option) {
  switch (option.by) {
    case Completed::flag:
      break;
    case Completed::file:
      return "action=-f";
    case Completed::folder:
      return "action=-d";
    case Completed::plugin:
      return "words=$(_weft_plugins)";
    case Completed::setting:
      return "words=\" $(_weft_settings)\"; compopt -o nospace 2>/dev/null";
    case Completed::choice:
      return fmt::format("words='{}'", fmt::join(option.choices, " "));
  }
  return "";
}

/// Possible words that begin without a dash.
std::string assignments_of(const CommandWords& command) {
  if (!command.commands.empty()) return fmt::format("words='{}'", fmt::join(command.commands, " "));
  const OptionWords* positional = command.positional();
  return positional != nullptr ? assignments_of(*positional) : "";
}

std::string options_of(const CommandWords& command) {
  std::vector<std::string> names;
  for (const OptionWords& option : command.options) {
    if (!option.positional) names.insert(names.end(), option.names.begin(), option.names.end());
  }
  return fmt::format("{}", fmt::join(names, " "));
}

}  // namespace

std::string bash_completion(const std::vector<CommandWords>& commands) {
  std::vector<std::string> paths;
  for (const CommandWords& command : commands) {
    if (&command != &commands.front()) paths.push_back(shell_word(command.path));
  }
  std::string script = kBashHead;
  script += fmt::format("      {}) at+=\" ${{COMP_WORDS[i]}}\" ;;\n    esac\n  done\n",
                        fmt::join(paths, " | "));
  script += "  case \"$at $previous\" in\n";
  for (const CommandWords& command : commands) {
    for (const OptionWords& option : command.options) {
      if (option.positional || option.by == Completed::flag) continue;
      std::vector<std::string> before;
      for (const std::string& name : option.names) {
        before.push_back(shell_word(command.path + " " + name));
      }
      script += fmt::format("    {}) {} ;;\n", fmt::join(before, " | "), assignments_of(option));
    }
  }
  script += "    *)\n      case $at in\n";
  for (const CommandWords& command : commands) {
    script += fmt::format("        {}) options='{}' {} ;;\n", shell_word(command.path),
                          options_of(command), assignments_of(command));
  }
  return script + kBashEnd;
}

}  // namespace weft::cli
