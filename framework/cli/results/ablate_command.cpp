// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <weft/core/shell_word.hpp>

#include "cli/commands.hpp"
#include "cli/ending/interruption.hpp"
#include "cli/output/duration_text.hpp"
#include "cli/output/report_text.hpp"
#include "cli/output/scratch_folder.hpp"
#include "cli/results/ablate_plan.hpp"
#include "cli/results/ablate_slurm.hpp"
#include "cli/results/cell_failures.hpp"
#include "cli/results/forecast_text.hpp"
#include "cli/results/varied_plan.hpp"
#include "cli/run/run_settings.hpp"
#include "cli/standard_components.hpp"
#include "lab/ablation/ablation.hpp"
#include "lab/results/expectations.hpp"
#include "lab/results/results_index.hpp"

namespace weft::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct AblateOptions {
  std::string plan, folder, engine = "local", isolate = "auto";
  std::vector<std::string> settings, without, varied;
  int jobs = 1;
  bool timing = false, accept_rebuilt = false, status = false, quiet = false;
  std::vector<std::string> retry;
  SlurmArguments slurm;

  int processes() const { return timing ? 1 : jobs; }
  bool retries(const char* what) const {
    return std::find(retry.begin(), retry.end(), what) != retry.end();
  }
};

constexpr const char* kSlurm = "slurm";

/// A line on the terminal that overwrites itself; elsewhere a line now and then.
class ProgressLine {
 public:
  ProgressLine(std::size_t cells, bool quiet)
      : cells_(cells),
        quiet_(quiet),
        terminal_(isatty(STDERR_FILENO) != 0),
        start_(Clock::now()),
        last_(start_) {}

  void show(double share) {
    constexpr auto kRarely = std::chrono::seconds(30);
    const auto now = Clock::now();
    if (quiet_ || (!terminal_ && now - last_ < kRarely)) return;
    last_ = now;
    const std::chrono::duration<double> spent = now - start_;
    const double left_s = share > 0.0 ? spent.count() / share * (1.0 - share) : 0.0;
    const std::string left = share > 0.0 ? duration_text(left_s) + " left" : "";
    const std::string line =
        fmt::format("{:.1f} of {} cells, {}", share * static_cast<double>(cells_), cells_, left);
    if (terminal_) fmt::print(stderr, "\r{:<60}", line);
    if (!terminal_) fmt::print(stderr, "{}\n", line);
  }

  void clear() const {
    if (!quiet_ && terminal_) fmt::print(stderr, "\r{:60}\r", "");
  }

 private:
  std::size_t cells_;
  bool quiet_, terminal_;
  Clock::time_point start_, last_;
};

/// The command that repeats the ablation, whatever the folder, the number of jobs and the times.
std::string command_of(const AblateOptions& options, const Context& context) {
  std::string command = "weft";
  for (const std::string& folder : context.plugin_path) {
    command += " --plugin-path " + shell_word(folder);
  }
  command += " ablate " + shell_word(options.plan);
  for (const std::string& name : options.without) command += " --without " + shell_word(name);
  for (const std::string& setting : options.settings) command += " --set " + shell_word(setting);
  return command;
}

/// The same as a job calls it, in its folder.
std::string slurm_call(const AblateOptions& options, const lab::ResultsFolder& folder,
                       const Context& context) {
  constexpr std::size_t kName = sizeof("weft") - 1;
  return program_word() + command_of(options, context).substr(kName) + " --out " +
         shell_word(folder.path()) + " --engine " + kSlurm + (options.timing ? " --timing" : "") +
         (options.accept_rebuilt ? " --accept-rebuilt" : "") +
         (options.isolate != "auto" ? " --isolate " + options.isolate : "");
}

bool print_expectations(const lab::Results& results) {
  bool all_met = true;
  for (const lab::PlanExpectation& expected : results.plan.expectations) {
    const lab::ExpectationOutcome outcome = lab::judge(results, expected);
    std::string bounds;
    if (!std::isnan(expected.at_least)) bounds += fmt::format(" at least {:g}", expected.at_least);
    if (!std::isnan(expected.at_most)) bounds += fmt::format(" at most {:g}", expected.at_most);
    const std::string figure = outcome.why_not.empty() ? fmt::format("mean {:.6g} of {} cells",
                                                                     outcome.mean, outcome.cells)
                                                       : outcome.why_not;
    fmt::print("{}: {} [{}]{}: {}\n", outcome.met ? "met" : "MISSED", expected.metric,
               lab::to_text(expected.where), bounds, figure);
    all_met = all_met && outcome.met;
  }
  return all_met;
}

void print_state(const lab::AblationState& state) {
  constexpr std::size_t kMost = 10;
  const std::string damaged = state.damaged > 0 ? fmt::format("{} damaged, ", state.damaged) : "";
  fmt::print(
      "{} cells ({} distinct): {} done, {} failed, {}{} left; {} stages, {} executed, {} reused\n",
      state.cells, state.keys, state.done, state.failed, damaged, state.left, state.stages,
      state.stages_executed, state.stages - state.stages_executed);
  for (const std::string& reason : state.reasons) fmt::print("left: {}\n", reason);
  const lab::CellRecords& records = state.results.records;
  const std::size_t shown = std::min(kMost, records.damaged.size());
  for (std::size_t i = 0; i < shown; ++i) {
    fmt::print("damaged: {}: {}\n", records.damaged[i].where, records.damaged[i].what);
  }
  if (records.damaged.size() > shown) {
    fmt::print("damaged: {} more results\n", records.damaged.size() - shown);
  }
  if (records.unchecked > 0) {
    fmt::print("unchecked: {} results of an older program, whose lines have no check\n",
               records.unchecked);
  }
}

Result<lab::AblationState> execute(lab::Grid& grid, const lab::ResultsFolder& folder,
                                   const AblateOptions& options, const Context& context) {
  const lab::AblationOptions how{options.timing, options.accept_rebuilt,
                                 command_of(options, context), options.retries("failed"),
                                 options.retries("damaged")};
  if (options.status) return lab::state_of(grid, folder, how);
  const std::atomic<bool>& interrupted = watch_for_interruption();
  now_running("the cells of the plan, in separate processes");
  const auto engine = options.engine == kSlurm
                          ? slurm_engine(slurm_call(options, folder, context), options.slurm,
                                         options.processes(), grid.plan().cluster)
                          : lab::local_engine(options.processes());
  ProgressLine line(grid.cells().size(), options.quiet);
  auto state = lab::run_ablation(
      grid, folder, *engine, how, [&](double share) { line.show(share); }, interrupted);
  line.clear();
  if (!state || options.engine == kSlurm) return state;
  if (auto index = lab::write_index(state->results, folder.path()); !index) {
    return index.error();
  }
  return state;
}

/// Runs commands that concern Slurm alone: true if nothing else is left to do.
bool manage_slurm(lab::Grid& grid, const AblateOptions& options, Context& context) {
  if (options.engine != kSlurm) return false;
  if (!options.slurm.task.empty()) {
    lab::AblationOptions how;
    how.timed = options.timing;
    how.accept_rebuilt = options.accept_rebuilt;
    context.exit_code =
        run_slurm_task(grid, options.slurm, options.folder, options.processes(), how);
  } else if (options.slurm.cancel) {
    context.exit_code = cancel_slurm(options.folder);
  } else {
    return false;
  }
  return true;
}

void ablate(AblateOptions options, Context& context) {
  if (options.engine != kSlurm && options.slurm.any()) {
    print_error(
        {Errc::invalid_value,
         "--partition, --sbatch, --chunk-minutes, --cell-seconds and --cancel need --engine slurm",
         {}});
    context.exit_code = kBadConfiguration;
    return;
  }
  const auto fail = [&](const Error& error) {
    print_error(error);
    context.exit_code = error.code == Errc::invalid_value ? kBadConfiguration : kInputOutput;
  };
  const auto registry = context.registry();
  std::optional<ScratchFolder> scratch;
  if (!options.varied.empty()) {
    auto made = ScratchFolder::make("weft-ablate");
    if (!made) return fail(made.error());
    scratch.emplace(*std::move(made));
    const VariedPipeline varied{options.plan, options.varied, options.settings, options.without};
    const auto plan = write_varied_plan(varied, registry, *scratch, options.status, options.folder);
    if (!plan) {
      context.exit_code = kBadConfiguration;
      return;
    }
    options.plan = *plan;
  }
  auto [grid, report] = lab::load_grid(options.plan, registry, options.settings, standard_helpers(),
                                       options.without, isolating_of(options.isolate));
  print_warnings(report);
  if (!report.ok()) {
    print_report(report);
    tell_slurm_failure(options.slurm, options.folder, report.text());
    context.exit_code = kBadConfiguration;
    return;
  }
  const std::string& plan = grid.plan().name;
  if (options.folder.empty()) options.folder = "ablations/" + plan;
  if (manage_slurm(grid, options, context)) return;
  const auto folder = options.status ? lab::ResultsFolder::look(options.folder, plan)
                                     : lab::ResultsFolder::open(options.folder, plan);
  if (!folder) {
    print_error(folder.error());
    context.exit_code = kBadConfiguration;
    return;
  }
  for (const std::string& file : folder->rebuilt()) fmt::print(stderr, "warning: {}\n", file);
  auto state = execute(grid, *folder, options, context);
  if (!state) return fail(state.error());
  if (options.engine == kSlurm && !options.status && !state->reasons.empty()) {
    return print_submitted(*state, options.folder);
  }
  Pace pace{options.processes(), fmt::format("--jobs {}", options.processes())};
  if (options.engine == kSlurm && options.status) pace = print_queue(*state, options.folder);
  if (!options.quiet) fmt::print("{}", lab::summary_table(state->results));
  print_failures(state->results);
  print_errors(state->results);
  print_state(*state);
  if (options.status) print_forecast(*state, options.folder, pace);
  const bool is_undamaged = state->results.records.damaged.empty();
  const bool whole = state->left == 0 && is_undamaged;
  const bool met = !whole || print_expectations(state->results);
  fmt::print("{}{}{}\n", options.folder,
             state->left > 0 ? " (not finished; run again to go on)" : "",
             is_undamaged ? "" : " (damaged results; run again with --retry damaged)");
  if (!whole || state->failed > 0 || !met) context.exit_code = kFramesFailed;
}

}  // namespace

void ablate_plan(const std::string& plan, const std::string& folder, int jobs,
                 const std::vector<std::string>& settings, bool is_dry, Context& context) {
  AblateOptions options;
  options.plan = plan;
  options.folder = folder;
  options.jobs = jobs;
  options.settings = settings;
  options.status = is_dry;
  ablate(std::move(options), context);
}

void add_ablate_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<AblateOptions>();
  CLI::App* command =
      app.add_subcommand("ablate", "Run a grid of pipelines, of a plan or of --vary; resumes");
  command->add_option("PLAN", options->plan, "Plan (YAML), or a pipeline with --vary")
      ->type_name("")
      ->required();
  command
      ->add_option("--vary", options->varied,
                   "PATH=VALUE,VALUE of a pipeline, such as filters.use=filters/aem,filters/vfc or "
                   "source.seed=1..8: runs all combinations, and writes the plan beside the "
                   "results; may be repeated")
      ->option_text("PATH=VALUES")
      ->allow_extra_args(false);
  command->add_option(
      "--out", options->folder,
      "Results folder, new or of this plan (default: ablations/<name of the plan>)");
  command->add_option("--jobs", options->jobs, "Processes; the results are the same for any number")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_flag("--timing", options->timing,
                    "Run each cell alone, nothing shared, one job, and keep the times");
  command->add_option("--engine", options->engine, "Where cells run")
      ->check(CLI::IsMember({"local", kSlurm}))
      ->capture_default_str();
  command->add_flag("--accept-rebuilt", options->accept_rebuilt,
                    "Take results of components of the same version that were built anew");
  command
      ->add_option("--set", options->settings,
                   "PATH=VALUE over all cells, such as source.frames=20, or over the plan, such as "
                   "data_use=tuning or axes.bend.values=[1, 2]; may be repeated")
      ->option_text("PATH=VALUE")
      ->allow_extra_args(false);
  add_without(*command, options->without);
  add_isolation(*command, options->isolate);
  CLI::Option* retry =
      command
          ->add_option("--retry", options->retry,
                       "Run cells again whose results failed, or are damaged; may be repeated")
          ->option_text("failed|damaged")
          ->check(CLI::IsMember({"failed", "damaged"}))
          ->allow_extra_args(false);
  command
      ->add_flag("--dry-run,--status", options->status,
                 "Print what is done, and how long the rest will take; run and write nothing")
      ->excludes(retry);
  add_slurm_options(*command, options->slurm);
  command->add_flag("--quiet", options->quiet, "No progress and no table");
  command->callback([&context, options] { ablate(*options, context); });
}

}  // namespace weft::cli
