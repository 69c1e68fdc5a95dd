// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <weft/core/version.hpp>

#include "commands.hpp"

namespace weft::cli {

void print_error(const Error& error) {
  fmt::print(stderr, "error: {}{}{}\n", error.where, error.where.empty() ? "" : ": ",
             error.message);
}

}  // namespace weft::cli

int main(int argc, char** argv) {
  CLI::App app{"Weft recovers the 3D shape of a deforming surface from one camera and a template."};
  app.set_version_flag("--version", weft::kVersion);
  app.require_subcommand(1);
  weft::cli::Context context;
  app.add_option("--plugin-path", context.plugin_path,
                 "Folder of plugins, searched before WEFT_PLUGIN_PATH; may be repeated")
      ->allow_extra_args(false);
  app.fallthrough();
  weft::cli::add_run_command(app, context);
  weft::cli::add_check_command(app, context);
  weft::cli::add_eval_command(app, context);
  weft::cli::add_plugins_command(app, context);
  weft::cli::add_replay_command(app, context);
  weft::cli::add_data_command(app, context);
  weft::cli::add_doctor_command(app, context);
  weft::cli::add_records_command(app, context);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? weft::cli::kDone : weft::cli::kBadConfiguration;
  } catch (const std::exception& error) {
    weft::cli::print_error({weft::Errc::io, error.what(), {}});
    return weft::cli::kInputOutput;
  }
  return context.exit_code;
}
