// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <weft/core/text_file.hpp>
#include <weft/core/whole_file.hpp>

#include "cli/data/sequence_maker.hpp"
#include "cli/output/generated_text.hpp"
#include "cli/output/scratch_folder.hpp"
#include "cli/results/ablate_plan.hpp"
#include "cli/results/compared_data.hpp"
#include "cli/run/run_settings.hpp"
#include "cli/standard_components.hpp"
#include "lab/ablation/plan/grid.hpp"
#include "lab/metrics/forms/metric_path.hpp"
#include "lab/report/tables/statistics.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

struct CompareOptions {
  std::vector<std::string> pipelines;
  std::vector<std::string> data, settings;
  std::string seeds, metric = lab::kErrorMetric, out;
  int jobs = 1;
  bool is_dry = false;
};

/// The name of a file without characters that the name of a value may not contain.
std::string plain_name(const std::string& file) {
  std::string name = fs::path(file).stem().string();
  std::replace_if(
      name.begin(), name.end(),
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '_' && c != '-'; }, '_');
  return name;
}

std::vector<std::string> names_of(const CompareOptions& options) {
  std::vector<std::string> names;
  for (const std::string& file : options.pipelines) names.push_back(plain_name(file));
  if (names[0] == names[1]) return {"first", "second"};
  return names;
}

/// The plan with which `weft ablate` repeats the comparison.
Result<GeneratedText> plan_text(const CompareOptions& options, const std::string& name,
                                const host::Registry& registry) {
  const std::vector<std::string> names = names_of(options);
  // Seeds up to 100 are for tuning. The caller is expected to know that, and requests no report.
  const long first_seed = std::strtol(options.seeds.c_str(), nullptr, 10);
  const bool tuning = !options.seeds.empty() && first_seed <= 100;
  GeneratedText text("weft compare");
  text.add("# The plan of `weft compare`; weft ablate runs it again.\nweft: 1\nname: " + name +
           "\npipeline:\n");
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string& file = options.pipelines[i];
    text.add("  " + names[i] + ": " + yaml_quoted(fs::absolute(file).string()) + "\n", file);
  }
  text.add(std::string("data_use: ") + (tuning ? "tuning" : "reporting") + "\n", "--seeds");
  text.add("data:\n");
  for (std::size_t i = 0; i < options.data.size(); ++i) {
    auto entries = compared_data(options.data[i], i + 1, registry);
    if (!entries) return entries.error();
    text.add(*entries, "--data " + options.data[i]);
  }
  if (options.data.empty()) {
    text.add(options.seeds.empty() ? "  own: {}\n" : "  own: {seeds: [" + options.seeds + "]}\n",
             options.seeds.empty() ? "" : "--seeds " + options.seeds);
  }
  const std::string metric = yaml_quoted(options.metric);
  text.add("show: [" + metric + ", counts.solved_percent]\ncomparisons:\n" +
               "  - {axis: pipeline, metric: " + metric + "}\n",
           "--metric " + options.metric);
  return text;
}

/// Why pipelines that keep their own sources cannot be compared; empty where they can.
std::string different_frames(const lab::Grid& grid) {
  const std::vector<lab::Cell>& cells = grid.cells();
  const auto source_of = [&](const lab::Cell& cell) {
    return grid.load(cell).first.config.source->component.effective;
  };
  const auto other = std::find_if(cells.begin(), cells.end(), [&](const auto& cell) {
    return cell.values.front() != cells.front().values.front();
  });
  if (other == cells.end() || source_of(*other) == source_of(cells.front())) return {};
  return "the two pipelines have different sources, so their frames cannot be paired; name the "
         "data that both are to read: --data FOLDER";
}

/// Loads the plan, so that errors are reported before anything runs.
bool is_sound(const std::string& plan, const GeneratedText& text, const CompareOptions& options,
              const host::Registry& registry) {
  auto [grid, report] = lab::load_grid(plan, registry, options.settings, standard_helpers());
  if (!report.ok()) {
    fmt::print(stderr, "{}", text.report_text(report, plan));
    return false;
  }
  const std::string why = options.data.empty() ? different_frames(grid) : "";
  if (!why.empty()) print_error({Errc::invalid_value, why, {}});
  return why.empty();
}

Result<void> print_answer(const std::string& folder, const std::string& metric) {
  const auto results = lab::read_results(folder);
  if (!results) return results.error();
  const auto table = lab::compare(*results, {"pipeline", metric, {}});
  if (!table) return table.error();
  const bool any_value = std::any_of(table->treatments.begin(), table->treatments.end(),
                                     [](const auto& treatment) { return treatment.sequences > 0; });
  if (!any_value) {
    return Error{Errc::not_found,
                 "no frame has a value of " + metric +
                     ": the data have no truth, or no frame was solved; name another with --metric "
                     "(weft metrics lists them)",
                 folder};
  }
  for (const lab::PairComparison& pair : table->pairs) fmt::print("{}\n", pair.sentence);
  return {};
}

void compare(CompareOptions options, Context& context) {
  const auto fail = [&](const Error& error, int exit_code) {
    print_error(error);
    context.exit_code = exit_code;
  };
  for (const std::string& file : options.pipelines) {
    if (auto found = check_input(file, InputKind::file); !found) {
      return fail(found.error(), kBadConfiguration);
    }
  }
  const std::vector<std::string> names = names_of(options);
  const std::string name = names[0] + "_and_" + names[1];
  if (options.out.empty()) options.out = "comparisons/" + name;
  const host::Registry registry = context.registry();
  const auto text = plan_text(options, name, registry);
  if (!text) return fail(text.error(), kBadConfiguration);
  // Nothing of a plan that is wrong, or of a dry run, is left.
  const auto scratch = ScratchFolder::make("weft-compare");
  if (!scratch) return fail(scratch.error(), kInputOutput);
  const std::string trial = scratch->path() + "/plan.yaml";
  if (auto written = write_whole(text->text(), trial); !written) {
    return fail(written.error(), kInputOutput);
  }
  if (!is_sound(trial, *text, options, registry)) {
    context.exit_code = kBadConfiguration;
    return;
  }
  if (options.is_dry) {
    return ablate_plan(trial, options.out, options.jobs, options.settings, true, context);
  }
  const std::string plan = options.out + ".yaml";
  std::error_code code;
  fs::create_directories(fs::absolute(plan).parent_path(), code);
  if (auto written = write_whole(text->text(), plan); !written) {
    return fail(written.error(), kInputOutput);
  }
  ablate_plan(plan, options.out, options.jobs, options.settings, false, context);
  if (context.exit_code != kDone && context.exit_code != kFramesFailed) return;
  if (auto answered = print_answer(options.out, options.metric); !answered) {
    fail(answered.error(), kInputOutput);
  }
}

}  // namespace

void add_compare_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<CompareOptions>();
  CLI::App* command = app.add_subcommand(
      "compare", "Compare two pipelines, and test whether their difference is significant");
  command->add_option("PIPELINES", options->pipelines, "The two pipelines (YAML)")
      ->type_name("")
      ->expected(2)
      ->required();
  CLI::Option* data =
      command
          ->add_option(
              "--data", options->data,
              "What `weft data info` reads, such as the folder of a sequence (frames, camera.yaml, "
              "gt), or a folder of several such folders; may be repeated (default: the source of "
              "the pipelines)")
          ->option_text("PATH")
          ->allow_extra_args(false);
  command
      ->add_option(
          "--seeds", options->seeds,
          "A sequence for each of these seeds of the pipelines' source, which must have the "
          "parameter seed, as sources/frex has: 101-110")
      ->option_text("SEEDS")
      ->excludes(data);
  command->add_option("--metric", options->metric, "What is compared; `weft metrics` lists them")
      ->capture_default_str();
  add_settings(*command, options->settings);
  command->add_option("--jobs", options->jobs, "Processes; the results are the same for any number")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_flag("--dry-run", options->is_dry,
                    "Print what is done, and how long the rest will take; run and write nothing");
  command->add_option("--out", options->out,
                      "Results folder, beside which the plan is written (default: "
                      "comparisons/<names of the two>)");
  command->footer(
      "Exit codes:\n"
      "  0  compared, whatever the answer\n"
      "  1  cells failed, or the comparison is not finished; run it again to go on\n"
      "  2  the command line or a pipeline is wrong\n"
      "  3  something cannot be read or written, or no frame has the metric");
  command->callback([&context, options] { compare(*options, context); });
}

}  // namespace weft::cli
