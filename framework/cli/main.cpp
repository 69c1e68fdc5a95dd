// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <cstdio>
#include <vector>
#include <weft/core/version.hpp>

#include "cli/commands.hpp"
#include "cli/ending/sudden_end.hpp"
#include "cli/output/home_paths.hpp"
#include "cli/output/standard_output.hpp"
#include "cli/shell/coloured_help.hpp"
#include "cli/shell/command_table.hpp"
#include "cli/shell/wrong_words.hpp"
#include "host/records/memory_pool.hpp"

namespace {

/// The exit code of the command that the arguments give.
int run_command(const std::vector<std::string>& arguments) {
  std::vector<const char*> words;
  for (const std::string& argument : arguments) words.push_back(argument.c_str());
  CLI::App app{"Weft recovers the 3D shape of a deforming surface from one camera and a template.",
               "weft"};
  app.set_version_flag("--version", weft::kVersion);
  app.require_subcommand(1);
  app.footer(
      "weft COMMAND --help has the options and exit codes of a command.\n"
      "Exit codes: without a command or with a wrong one 2; all commands exit with 3 when their\n"
      "standard output cannot be written.");
  weft::cli::Context context;
  app.add_option("--plugin-path", context.plugin_path,
                 "Folder of plugins, searched before WEFT_PLUGIN_PATH; may be repeated")
      ->option_text("FOLDER")
      ->allow_extra_args(false);
  app.fallthrough();
  weft::cli::add_commands(app, context);
  try {
    app.parse(static_cast<int>(words.size()), words.data());
  } catch (const CLI::CallForHelp&) {
    const weft::cli::Colours colours = weft::cli::colours_of(stdout);
    fmt::print("{}", weft::cli::coloured_help(app.help(), colours));
    return weft::cli::kDone;
  } catch (const CLI::Success& asked) {
    app.exit(asked);  // the version
    return weft::cli::kDone;
  } catch (const CLI::ParseError& error) {
    weft::cli::print_wrong_words(app, "weft", error);
    return weft::cli::kBadConfiguration;
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return weft::cli::kInputOutput;  // reported at the end
    weft::cli::print_error({weft::Errc::io, error.what(), {}});
    return weft::cli::kInputOutput;
  }
  return context.exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  weft::cli::guard_standard_streams();
  weft::host::keep_freed_memory();
  const weft::cli::SuddenEndWatch watch;
  const auto arguments = weft::cli::expand_arguments(argc, argv);
  if (!arguments) {
    weft::cli::print_error(arguments.error());
    return weft::cli::kBadConfiguration;
  }
  int exit_code = run_command(*arguments);
  if (weft::cli::standard_output_failed()) exit_code = weft::cli::kInputOutput;
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(WEFT_COVERAGE)
  // Handlers and destructors that libraries have registered could crash, hang or print.
  std::fflush(nullptr);
  weft::cli::end_at_once(exit_code);
#endif
  return exit_code;
}
