// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <memory>
#include <weft/evaluation/metrics_report.hpp>

#include "commands.hpp"

namespace weft::cli {
namespace {

struct Options {
  std::string folder;
  std::string json_file;  ///< "-" is the standard output
  std::string alignment = "none";
  bool no_save = false;
  bool quiet = false;
};

Result<void> evaluate(const Options& options) {
  evaluation::EvaluationOptions choice;
  choice.alignment = *evaluation::alignment_of(options.alignment);
  const auto metrics = evaluation::evaluate_run(options.folder, choice);
  if (!metrics) return metrics.error();
  if (!options.no_save) {
    const std::string file =
        options.folder + "/" + evaluation::metrics_file_name(metrics->alignment);
    if (auto written = evaluation::write_json(*metrics, file); !written) return written;
  }
  if (options.json_file == "-") {
    fmt::print("{}", evaluation::to_json(*metrics));
    return {};
  }
  if (!options.json_file.empty()) {
    if (auto written = evaluation::write_json(*metrics, options.json_file); !written) {
      return written;
    }
  }
  if (!options.quiet) fmt::print("{}", evaluation::to_table(*metrics));
  return {};
}

}  // namespace

void add_eval_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("eval", "Measure a run against its ground truth; writes metrics.json");
  command->add_option("RUN", options->folder, "Folder that `weft run` wrote")->required();
  command->add_option("--json", options->json_file,
                      "Write the metrics to this file too; - prints them instead of the table");
  command
      ->add_option("--align", options->alignment,
                   "Take out one scale or one rigid motion a frame first; the table says so")
      ->check(CLI::IsMember({"none", "scale", "rigid"}))
      ->capture_default_str();
  command->add_flag("--no-save", options->no_save, "Write nothing into the run folder");
  command->add_flag("--quiet", options->quiet, "No table");
  command->callback([&context, options] {
    if (auto done = evaluate(*options); !done) {
      print_error(done.error());
      context.exit_code = kInputOutput;
    }
  });
}

}  // namespace weft::cli
