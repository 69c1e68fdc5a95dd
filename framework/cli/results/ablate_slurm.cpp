// SPDX-License-Identifier: Apache-2.0
#include "cli/results/ablate_slurm.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <weft/core/shell_word.hpp>

#include "cli/commands.hpp"
#include "cli/ending/interruption.hpp"
#include "cli/output/duration_text.hpp"
#include "lab/cluster/queue.hpp"
#include "lab/cluster/slurm_engine.hpp"
#include "lab/cluster/task.hpp"

namespace weft::cli {

bool SlurmArguments::any() const {
  return !partition.empty() || !sbatch.empty() || chunk_minutes > 0.0 || cell_seconds > 0.0 ||
         cancel || !task.empty();
}

void add_slurm_options(CLI::App& command, SlurmArguments& arguments) {
  constexpr const char* kGroup = "With --engine slurm";
  command.add_option("--partition", arguments.partition, "Partition that the jobs go to")
      ->group(kGroup);
  command
      .add_option("--sbatch", arguments.sbatch,
                  "Further option of sbatch, such as --sbatch=--mem=4G; may be repeated")
      ->option_text("OPTION")
      ->allow_extra_args(false)
      ->group(kGroup);
  command
      .add_option("--chunk-minutes", arguments.chunk_minutes,
                  "Minutes that a task is to take (default: 10)")
      ->check(CLI::PositiveNumber)
      ->group(kGroup);
  command
      .add_option("--cell-seconds", arguments.cell_seconds,
                  "Seconds that a cell takes (default: as measured in this folder, or 30)")
      ->check(CLI::PositiveNumber)
      ->group(kGroup);
  command.add_flag("--cancel", arguments.cancel, "End all tasks; finished cells stay")
      ->excludes("--status")
      ->group(kGroup);
  command.add_option("--task", arguments.task)->group("");  // argument of jobs
}

std::string program_word() {
  std::error_code code;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", code);
  return shell_word(code ? "weft" : program.string());
}

std::unique_ptr<lab::Engine> slurm_engine(const std::string& call, const SlurmArguments& arguments,
                                          int processes, const lab::PlannedCluster& planned) {
  cluster::SlurmOptions options;
  options.command = call;
  options.partition = arguments.partition.empty() ? planned.partition : arguments.partition;
  options.sbatch = planned.sbatch;
  options.sbatch.insert(options.sbatch.end(), arguments.sbatch.begin(), arguments.sbatch.end());
  options.chunk_minutes = arguments.chunk_minutes > 0.0
                              ? arguments.chunk_minutes
                              : planned.chunk_minutes.value_or(options.chunk_minutes);
  options.cell_seconds = planned.cell_seconds;
  if (arguments.cell_seconds > 0.0) options.cell_seconds = arguments.cell_seconds;
  options.processes = processes;
  return cluster::slurm_engine(std::move(options));
}

int run_slurm_task(lab::Grid& grid, const SlurmArguments& arguments, const std::string& folder,
                   int processes, const lab::AblationOptions& how) {
  const auto id = cluster::task_id(arguments.task);
  if (!id) {
    print_error(id.error());
    return kBadConfiguration;
  }
  if (how.accept_rebuilt) {
    // Cells then have the keys under which they were submitted.
    const auto looked = lab::ResultsFolder::look(folder, grid.plan().name);
    if (looked) static_cast<void>(lab::state_of(grid, *looked, how));
  }
  const std::atomic<bool>& interrupted = watch_for_interruption();
  now_running("the cells of a task, in separate processes");
  const auto report = cluster::run_task(grid, folder, *id, processes, how.timed, interrupted);
  if (!report) {
    print_error(report.error());
    return kInputOutput;
  }
  for (const std::string& reason : report->left) fmt::print("left: {}\n", reason);
  fmt::print("{} cells in {}\n", report->cells, duration_text(report->seconds));
  return report->left.empty() ? kDone : kFramesFailed;
}

int cancel_slurm(const std::string& folder) {
  const auto ended = cluster::cancel_tasks(folder);
  if (!ended) {
    print_error(ended.error());
    return kInputOutput;
  }
  fmt::print("{}: {} tasks ended; run again to go on with what is left\n", folder, *ended);
  return kDone;
}

void tell_slurm_failure(const SlurmArguments& arguments, const std::string& folder,
                        const std::string& reason) {
  if (arguments.task.empty()) return;
  const auto id = cluster::task_id(arguments.task);
  const auto reported =
      id ? cluster::report_failure(folder, *id, reason) : Result<void>(id.error());
  if (!reported) print_error(reported.error());
}

void print_submitted(const lab::AblationState& state, const std::string& folder) {
  for (const std::string& reason : state.reasons) fmt::print("{}\n", reason);
  fmt::print("{} (--status prints their progress, --cancel ends them; run again for the rest)\n",
             folder);
}

Pace print_queue(lab::AblationState& state, const std::string& folder) {
  std::set<std::string> left;
  for (const lab::PlanCell& cell : state.results.plan.cells) {
    if (state.results.records.cells.count(cell.key) == 0) left.insert(cell.key);
  }
  const auto queue = cluster::look_at_queue(folder, left);
  if (!queue) {
    fmt::print("what waits and runs is not known: {}\n", queue.error().message);
    return {1, "one process"};
  }
  fmt::print("{} tasks run, {} wait, {} ended; {} cells are on their way\n", queue->running,
             queue->waiting, queue->ended, queue->on_their_way);
  constexpr std::size_t kMost = 10;
  const std::size_t shown = std::min(kMost, queue->reasons.size());
  state.reasons.assign(queue->reasons.begin(), queue->reasons.begin() + shown);
  if (queue->reasons.size() > shown) {
    state.reasons.push_back(fmt::format("{} more reasons", queue->reasons.size() - shown));
  }
  if (queue->processes == 0) return {1, "one process", queue->cell_seconds};
  return {queue->processes, fmt::format("the {} processes that run", queue->processes),
          queue->cell_seconds};
}

}  // namespace weft::cli
