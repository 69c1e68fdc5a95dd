// SPDX-License-Identifier: Apache-2.0
#include "cli/shell/command_table.hpp"

#include <fmt/core.h>

#include <memory>
#include <sstream>

namespace weft::cli {
namespace {

struct Group {
  const char* name;
  std::vector<void (*)(CLI::App&, Context&)> commands;
};

const std::vector<Group>& groups() {
  static const std::vector<Group> kGroups{
      {"Start here", {add_live_command, add_track_command, add_init_command, add_doctor_command}},
      {"Run",
       {add_run_command, add_check_command, add_replay_command, add_migrate_command,
        add_calibrate_command}},
      {"Look", {add_graph_command, add_report_command, add_data_command, add_template_command}},
      {"Measure", {add_eval_command, add_bench_command, add_metrics_command}},
      {"Compare", {add_compare_command, add_ablate_command}},
      {"Extend",
       {add_plugins_command, add_records_command, add_schema_command, add_completion_command,
        add_manual_command}}};
  return kGroups;
}

constexpr const char* kExamples =
    R"(
Examples:
  weft live --demo                                      a moving surface in the browser
  weft run pipelines/demo.yaml                          meshes, a video and times in runs/demo
  weft track photos/ --object scan.png --width 0.2159   meshes from photographs, without YAML
)";

/// The help of the program: examples, commands, options.
class ProgramHelp : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    return make_description(app) + make_usage(app, std::move(name)) + kExamples +
           make_subcommands(app, mode) + make_groups(app, mode) + "\n" + make_footer(app);
  }
  std::string make_subcommand(const CLI::App* command) const override {
    return fmt::format("  {:<12}{}\n", command->get_name(), command->get_description());
  }
};

}  // namespace

void add_commands(CLI::App& program, Context& context) {
  for (const Group& group : groups()) {
    for (const auto add : group.commands) {
      add(program, context);
      program.get_subcommands({}).back()->group(group.name);
    }
  }
  program.formatter(std::make_shared<ProgramHelp>());  // not inherited by the commands above
}

}  // namespace weft::cli
