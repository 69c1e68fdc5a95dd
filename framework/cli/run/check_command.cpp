// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "cli/commands.hpp"
#include "cli/ending/interruption.hpp"
#include "cli/output/report_text.hpp"
#include "cli/run/run_settings.hpp"
#include "cli/standard_components.hpp"
#include "lab/ablation/plan/grid.hpp"
#include "pipeline/overview/origins.hpp"
#include "pipeline/overview/settable.hpp"
#include "pipeline/runs/run.hpp"

namespace weft::cli {
namespace {

struct CheckOptions {
  std::vector<std::string> files, settings, without;
  bool show = false, list = false;
};

/// Messages about a valid file; the report has the errors of an invalid one.
std::pair<std::string, ConfigReport> check_file(const std::string& file,
                                                const CheckOptions& options,
                                                const host::Registry& registry) {
  if (lab::is_plan(file)) {
    now_running("the checks of " + file);
    auto [grid, report] =
        lab::load_grid(file, registry, options.settings, standard_helpers(), options.without);
    return {fmt::format("a plan of {} cells", grid.cells().size()), std::move(report)};
  }
  const std::string folder = std::filesystem::absolute(free_folder(file)).string();
  host::ComponentChecks checks = checks_of(file);
  auto [pipeline, report] = check_pipeline(file, registry, folder, options.settings, {}, &checks);
  return {fmt::format("{} stages, {} sinks", pipeline.config.stages.size(),
                      pipeline.config.sinks.size()),
          std::move(report)};
}

/// Prints one pipeline with the origins of its values, or what can be set in it. `list` also works
/// for a pipeline with errors, since completion needs it while a command line is typed.
void show(const CheckOptions& options, const host::Registry& registry, Context& context) {
  const std::string& file = options.files.front();
  if (options.files.size() > 1 || lab::is_plan(file)) {
    print_error({Errc::invalid_value, "--show and --list take one pipeline", options.files.back()});
    context.exit_code = kBadConfiguration;
    return;
  }
  const std::string folder = std::filesystem::absolute(free_folder(file)).string();
  PipelineDocument document =
      read_document(file, options.settings, registry, host::PathRules::of_process({}, folder));
  const yaml::Node root = document.root;
  host::ComponentChecks checks = checks_of(file);
  const auto [pipeline, report] =
      check_pipeline(file, std::move(document), registry, folder, &checks);
  print_warnings(report);
  if (!report.ok()) {
    print_report(report);
    context.exit_code = kBadConfiguration;
  }
  if (options.list) {
    for (const Settable& each : settable_in(pipeline.config, root)) {
      fmt::print("{}\t{}\t{}\n", each.path, each.value, each.help);
    }
  } else if (report.ok()) {
    fmt::print("{}", yaml_with_origins(pipeline.config, root));
  }
}

void check(const CheckOptions& options, Context& context) {
  const host::Registry registry = context.registry();
  if (options.show || options.list) return show(options, registry, context);
  for (const std::string& file : options.files) {
    if (!options.without.empty() && !lab::is_plan(file)) {
      print_error({Errc::invalid_value,
                   "--without is for plans; a pipeline has 'without' in its file", file});
      context.exit_code = kBadConfiguration;
      continue;
    }
    const auto [content, report] = check_file(file, options, registry);
    print_warnings(report);
    if (report.ok()) {
      fmt::print("{}: ok, {}\n", file, content);
      continue;
    }
    print_report(report);
    context.exit_code = kBadConfiguration;
  }
}

}  // namespace

void add_check_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<CheckOptions>();
  CLI::App* command = app.add_subcommand(
      "check", "Check pipelines and ablation plans without running them; lists all errors");
  command->add_option("FILE", options->files, "Pipelines and plans (YAML)")
      ->type_name("")
      ->required();
  add_settings(*command, options->settings);
  add_without(*command, options->without);
  CLI::Option* show = command->add_flag(
      "--show", options->show,
      "Print the merged pipeline, as YAML that can be run, with the origin of each value");
  command
      ->add_flag("--list", options->list,
                 "Print what --set can set in a pipeline: path, value and meaning, with tabs")
      ->excludes(show);
  command->footer(
      "Exit codes:\n"
      "  0  the pipelines, and every cell of the plans, can be run\n"
      "  2  the command line or a file is wrong");
  command->callback([&context, options] { check(*options, context); });
}

}  // namespace weft::cli
