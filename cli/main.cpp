// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdio>
#include <string_view>
#include <weft/core/suggest.hpp>
#include <weft/core/version.hpp>

#include "cli/commands.hpp"
#include "cli/output/standard_output.hpp"
#include "cli/run/sudden_end.hpp"

namespace {

/// What is wrong with the name of a command; empty when something else is.
std::string wrong_command(const CLI::App& app) {
  const CLI::App* last = &app;
  while (!last->get_subcommands().empty()) last = last->get_subcommands().front();
  std::vector<std::string> known;
  for (const CLI::App* command : last->get_subcommands([](const CLI::App*) { return true; })) {
    known.push_back(command->get_name());
  }
  const std::vector<std::string> unknown = app.remaining();
  if (known.empty() || unknown.empty() || unknown.front().starts_with("-")) return {};
  const std::string all = fmt::format("; there are: {}", fmt::join(known, ", "));
  return fmt::format("no command '{}'{}", unknown.front(),
                     weft::did_you_mean(unknown.front(), known, all));
}

/// The exit code of the command that the arguments give.
int run_command(int argc, char** argv) {
  CLI::App app{"Weft recovers the 3D shape of a deforming surface from one camera and a template."};
  app.set_version_flag("--version", weft::kVersion);
  app.require_subcommand(1);
  app.footer("All commands exit with 3 when their standard output cannot be written.");
  weft::cli::Context context;
  app.add_option("--plugin-path", context.plugin_path,
                 "Folder of plugins, searched before WEFT_PLUGIN_PATH; may be repeated")
      ->option_text("FOLDER")
      ->allow_extra_args(false);
  app.fallthrough();
  weft::cli::add_run_command(app, context);
  weft::cli::add_init_command(app, context);
  weft::cli::add_live_command(app, context);
  weft::cli::add_check_command(app, context);
  weft::cli::add_eval_command(app, context);
  weft::cli::add_ablate_command(app, context);
  weft::cli::add_compare_command(app, context);
  weft::cli::add_data_command(app, context);
  weft::cli::add_plugins_command(app, context);
  weft::cli::add_replay_command(app, context);
  weft::cli::add_bench_command(app, context);
  weft::cli::add_doctor_command(app, context);
  weft::cli::add_records_command(app, context);
  weft::cli::add_metrics_command(app, context);
  weft::cli::add_report_command(app, context);
  weft::cli::add_template_command(app, context);
  weft::cli::add_calibrate_command(app, context);
  weft::cli::add_schema_command(app, context);
  weft::cli::add_completion_command(app, context);
  weft::cli::add_manual_command(app, context);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const std::string message = error.get_exit_code() != 0 ? wrong_command(app) : "";
    if (message.empty()) {
      return app.exit(error) == 0 ? weft::cli::kDone : weft::cli::kBadConfiguration;
    }
    weft::cli::print_error({weft::Errc::invalid_value, message, {}});
    return weft::cli::kBadConfiguration;
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return weft::cli::kInputOutput;  // said at the end
    weft::cli::print_error({weft::Errc::io, error.what(), {}});
    return weft::cli::kInputOutput;
  }
  return context.exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  weft::cli::guard_standard_streams();
  const weft::cli::SuddenEndWatch watch;
  const int exit_code = run_command(argc, argv);
  return weft::cli::standard_output_failed() ? weft::cli::kInputOutput : exit_code;
}
