// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <weft/core/suggest.hpp>
#include <weft/core/whole_file.hpp>

#include "cli/commands.hpp"
#include "cli/shell/manual_page.hpp"

namespace weft::cli {
namespace {

struct ManualOptions {
  std::vector<std::string> command;
  std::string folder;
};

Result<void> write_all(const std::vector<CommandWords>& commands,
                       const std::filesystem::path& folder) {
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (code) return Error{Errc::io, "cannot be created: " + code.message(), folder.string()};
  for (const CommandWords& command : commands) {
    auto written =
        write_whole(manual_page(command, commands), folder / (manual_name(command) + ".1"));
    if (!written) return written;
  }
  return {};
}

Result<void> print_one(const std::vector<CommandWords>& commands,
                       const std::vector<std::string>& wanted) {
  std::vector<std::string> known;
  const std::string path =
      fmt::format("weft{}{}", wanted.empty() ? "" : " ", fmt::join(wanted, " "));
  for (const CommandWords& command : commands) {
    if (command.path == path) {
      fmt::print("{}", manual_page(command, commands));
      return {};
    }
    known.push_back(command.path);
  }
  return Error{Errc::not_found, "no command '" + path + "'" + did_you_mean(path, known), {}};
}

}  // namespace

void add_manual_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<ManualOptions>();
  CLI::App* command = app.add_subcommand(
      "manual", "Print the manual page of the program or of a command, for man -l -");
  command->add_option("COMMAND", options->command, "Such as: plugins show")->type_name("");
  command->add_option("--out", options->folder, "Write all pages into this folder instead")
      ->option_text("FOLDER");
  command->footer(
      "Exit codes:\n"
      "  0  printed or written\n"
      "  2  there is no such command\n"
      "  3  a page cannot be written");
  command->callback([&app, &context, options] {
    const std::vector<CommandWords> commands = command_words(app);
    const auto done = options->folder.empty() ? print_one(commands, options->command)
                                              : write_all(commands, options->folder);
    if (done) return;
    print_error(done.error());
    context.exit_code = done.error().code == Errc::not_found ? kBadConfiguration : kInputOutput;
  });
}

}  // namespace weft::cli
