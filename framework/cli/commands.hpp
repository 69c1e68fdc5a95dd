// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/output/outcome.hpp"
#include "host/loading/registry.hpp"

namespace weft::cli {

/// State that all commands share.
struct Context {
  std::vector<std::string> plugin_path;  ///< --plugin-path, in order
  int exit_code = kDone;

  host::Registry registry() const { return host::Registry::scan(host::search_path(plugin_path)); }
};

// Each adds its subcommand; its callback sets Context::exit_code.
void add_run_command(CLI::App& app, Context& context);
void add_track_command(CLI::App& app, Context& context);
void add_init_command(CLI::App& app, Context& context);
void add_live_command(CLI::App& app, Context& context);
void add_bench_command(CLI::App& app, Context& context);
void add_check_command(CLI::App& app, Context& context);
void add_graph_command(CLI::App& app, Context& context);
void add_migrate_command(CLI::App& app, Context& context);
void add_plugins_command(CLI::App& app, Context& context);
void add_eval_command(CLI::App& app, Context& context);
void add_replay_command(CLI::App& app, Context& context);
void add_data_command(CLI::App& app, Context& context);
void add_doctor_command(CLI::App& app, Context& context);
void add_ablate_command(CLI::App& app, Context& context);
void add_compare_command(CLI::App& app, Context& context);
void add_records_command(CLI::App& app, Context& context);
void add_metrics_command(CLI::App& app, Context& context);
void add_report_command(CLI::App& app, Context& context);
void add_template_command(CLI::App& app, Context& context);
void add_calibrate_command(CLI::App& app, Context& context);
void add_schema_command(CLI::App& app, Context& context);
void add_completion_command(CLI::App& app, Context& context);
void add_manual_command(CLI::App& app, Context& context);

}  // namespace weft::cli
