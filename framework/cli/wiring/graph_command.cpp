// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "cli/commands.hpp"
#include "cli/output/report_text.hpp"
#include "cli/run/run_settings.hpp"
#include "cli/wiring/measured_times.hpp"
#include "pipeline/overview/drawing.hpp"
#include "pipeline/runs/run.hpp"

namespace weft::cli {
namespace {

struct GraphOptions {
  std::string pipeline, format = "text", run;
  std::vector<std::string> settings;
};

std::string drawn(const WiringChart& chart, const std::string& format) {
  if (format == "svg") return chart_svg(chart);
  if (format == "mermaid") return chart_mermaid(chart);
  return format == "dot" ? chart_dot(chart) : chart_text(chart);
}

void graph(const GraphOptions& options, Context& context) {
  const host::Registry registry = context.registry();
  const std::string folder = std::filesystem::absolute(free_folder(options.pipeline)).string();
  const auto [pipeline, report] =
      check_pipeline(options.pipeline, registry, folder, options.settings);
  print_warnings(report);
  if (!report.ok()) {
    print_report(report);
    context.exit_code = kBadConfiguration;
    return;
  }
  std::map<std::string, double> times_ms;
  if (!options.run.empty()) {
    auto measured = measured_times_ms(pipeline.config, options.run);
    if (!measured) {
      print_error(measured.error());
      context.exit_code = kInputOutput;
      return;
    }
    times_ms = *std::move(measured);
  }
  fmt::print("{}", drawn(wiring_chart(pipeline, times_ms), options.format));
}

}  // namespace

void add_graph_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<GraphOptions>();
  CLI::App* command =
      app.add_subcommand("graph", "Draw which component reads what another one makes");
  command->add_option("PIPELINE", options->pipeline, "Pipeline file (YAML)")
      ->type_name("")
      ->required();
  command->add_option("--format", options->format, "Printed form")
      ->check(CLI::IsMember({"text", "svg", "mermaid", "dot"}))
      ->option_text("text|svg|mermaid|dot [text]");
  command
      ->add_option("--run", options->run,
                   "Folder of a run of the pipeline, whose median times are shown")
      ->option_text("FOLDER");
  add_settings(*command, options->settings);
  command->footer(
      "A filled mark is an output or a required input, an open one an optional input.\n"
      "Exit codes:\n"
      "  0  printed\n"
      "  2  the command line or the pipeline is wrong\n"
      "  3  the run cannot be read");
  command->callback([&context, options] { graph(*options, context); });
}

}  // namespace weft::cli
