// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <memory>

#include "cli/commands.hpp"
#include "cli/output/new_file.hpp"
#include "cli/results/run_registration.hpp"
#include "lab/metrics/forms/metrics_report.hpp"

namespace weft::cli {
namespace {

struct EvalOptions {
  std::string folder;
  std::string json_file;  ///< "-" is the standard output
  std::string csv_file;
  std::string alignment = "none";
  double match_tolerance_px = 2.0;
  bool frames = false;
  bool surfaces = false;
  bool no_save = false;
  bool quiet = false;
  bool overwrite = false;  ///< json_file and csv_file
  FlatReference reference;
};

/// Measures registrations with `registration`, where it is there, and keeps them in the run.
Result<void> evaluate(const EvalOptions& options, const std::string& alignment,
                      RunRegistration* registration) {
  lab::EvaluationOptions choice;
  choice.alignment = *lab::alignment_of(alignment);
  choice.match_tolerance_px = options.match_tolerance_px;
  if (options.surfaces) choice.surface_samples = lab::kSurfaceSamples;
  if (registration != nullptr) {
    choice.measure_registration = [&](const auto& line, const auto& records) {
      return registration->measure(line, records);
    };
  }
  const auto metrics = lab::evaluate_run(options.folder, choice);
  if (!metrics) return metrics.error();
  for (const std::string& text : metrics->warnings) fmt::print(stderr, "warning: {}\n", text);
  if (!options.no_save && registration != nullptr) {
    auto kept = lab::write_registrations(options.folder, registration->measured());
    if (!kept) return kept;
  }
  if (!options.no_save) {
    const std::string file = options.folder + "/" + lab::metrics_file_name(metrics->alignment);
    if (auto written = lab::write_json(*metrics, file); !written) return written;
  }
  if (options.json_file == "-") {
    fmt::print("{}", lab::to_json(*metrics));
    return {};
  }
  if (!options.json_file.empty()) {
    if (auto written = lab::write_json(*metrics, options.json_file); !written) {
      return written;
    }
  }
  if (!options.csv_file.empty()) {
    if (auto written = lab::write_csv(*metrics, options.csv_file); !written) return written;
  }
  if (options.quiet) return {};
  const bool further = options.alignment == "all" && metrics->alignment != lab::Alignment::none;
  fmt::print("{}", further ? lab::to_error_table(*metrics) : lab::to_table(*metrics));
  if (options.frames) fmt::print("{}", lab::to_frames_table(*metrics));
  return {};
}

Result<void> evaluate_all(const EvalOptions& options, const Context& context) {
  for (const std::string& file : {options.json_file, options.csv_file}) {
    if (file.empty() || file == "-") continue;
    if (auto fresh = check_new_file(file, options.overwrite); !fresh) return fresh;
  }
  std::unique_ptr<RunRegistration> registration;
  if (options.reference.wanted) {
    auto opened = RunRegistration::open(options.folder, options.reference, context.registry());
    if (!opened) return opened.error();
    registration = *std::move(opened);
  }
  if (options.alignment != "all") return evaluate(options, options.alignment, registration.get());
  if (!options.json_file.empty() || !options.csv_file.empty()) {
    return Error{Errc::invalid_value,
                 "--alignment all writes metrics.json, metrics_scale.json and metrics_rigid.json "
                 "into the run; --json and --csv write one alignment: choose one"};
  }
  for (const char* alignment : {"none", "scale", "rigid"}) {
    if (auto done = evaluate(options, alignment, registration.get()); !done) return done;
  }
  return {};
}

}  // namespace

void add_eval_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<EvalOptions>();
  CLI::App* command =
      app.add_subcommand("eval", "Measure a run against its ground truth; writes metrics.json");
  command->add_option("RUN", options->folder, "Folder that `weft run` wrote")
      ->type_name("")
      ->required();
  command
      ->add_option("--json", options->json_file,
                   "Write the metrics to this file too; - prints them instead of the table")
      ->option_text("FILE");
  command
      ->add_option("--alignment", options->alignment,
                   "Remove one scale or one rigid motion a frame first; the table states it. With "
                   "all: none, scale and rigid one after another, into metrics.json, "
                   "metrics_scale.json and metrics_rigid.json; without --json and --csv")
      ->option_text("none|scale|rigid|all (default: " + options->alignment + ")")
      ->check(CLI::IsMember({"none", "scale", "rigid", "all"}));
  command->add_option("--csv", options->csv_file, "Write a row for each frame to this file")
      ->option_text("FILE");
  command
      ->add_option("--match-tolerance-px", options->match_tolerance_px,
                   "A match this near the true image of its template point is correct")
      ->option_text(fmt::format("PX (default: {:g})", options->match_tolerance_px))
      ->check(CLI::PositiveNumber);
  command->add_flag("--frames", options->frames,
                    "Print a row for each frame too, and the frames with the largest errors");
  command->add_flag(
      "--surfaces", options->surfaces,
      fmt::format("Add Chamfer distances as the literature has them, between {} random places on "
                  "the mesh and the points of the truth, and print all",
                  lab::kSurfaceSamples));
  command
      ->add_option_function<std::vector<std::string>>(
          "--flat-reference",
          [options](const std::vector<std::string>& words) {
            options->reference.wanted = true;
            if (!words.empty()) options->reference.words = words.front();
          },
          "Compare the images, unwarped through the shapes, with the template's texture at these "
          "words, or at the cells of a grid; images are read again. Write it behind RUN")
      ->option_text("[WORDS.json]")
      ->expected(0, 1);
  command
      ->add_option("--flat-set", options->reference.settings,
                   "Set a parameter of passes/flat_reference: range_mm=20")
      ->option_text("NAME=VALUE")
      ->needs("--flat-reference");
  command->add_flag("--no-save", options->no_save, "Write nothing into the run folder");
  add_overwrite(*command, options->overwrite);
  command->add_flag("--quiet", options->quiet, "No table");
  command->footer(
      "Exit codes:\n"
      "  0  measured\n"
      "  2  the command line is wrong\n"
      "  3  a file or folder cannot be read or written");
  command->callback([&context, options] {
    if (auto done = evaluate_all(*options, context); !done) {
      print_error(done.error());
      const bool misuse = done.error().code == Errc::invalid_value;
      context.exit_code = misuse ? kBadConfiguration : kInputOutput;
    }
  });
}

}  // namespace weft::cli
