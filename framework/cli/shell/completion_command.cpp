// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <memory>

#include "cli/commands.hpp"
#include "cli/shell/completion.hpp"

namespace weft::cli {

void add_completion_command(CLI::App& app, Context&) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("completion", "Print a script that completes the command line of weft");
  command->add_option("SHELL", *shell, "Whose language it is in")
      ->option_text("bash|zsh|fish REQUIRED")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->footer(
      "Exit codes:\n"
      "  0  printed\n"
      "  2  the command line is wrong");
  command->callback([&app, shell] {
    const std::vector<CommandWords> commands = command_words(app);
    const auto script = *shell == "bash"  ? bash_completion
                        : *shell == "zsh" ? zsh_completion
                                          : fish_completion;
    fmt::print("{}", script(commands));
  });
}

}  // namespace weft::cli
