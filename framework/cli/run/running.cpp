// SPDX-License-Identifier: Apache-2.0
#include "cli/run/running.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <tuple>

#include "cli/ending/interruption.hpp"
#include "cli/ending/running_calls.hpp"
#include "cli/output/report_text.hpp"
#include "cli/output/source_excerpt.hpp"
#include "cli/run/recorded_run.hpp"
#include "cli/run/run_settings.hpp"
#include "cli/run/run_statistics.hpp"
#include "pipeline/configuration/declared_paths.hpp"
#include "pipeline/runs/run.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

/// Counts what becomes of the frames of a run, shows it on the terminal while it runs, and passes
/// on where the run is.
class Progress final : public RunObserver {
 public:
  Progress(const RunArguments& arguments, const PipelineConfig& config)
      : arguments_(arguments),
        config_(config),
        shows_bar_(!arguments.quiet && isatty(STDERR_FILENO) != 0) {}

  void started(std::int64_t frames) override {
    total_ = frames;
    if (arguments_.started) arguments_.started(config_);
  }

  void frame_done(const FrameResult& frame) override {
    statistics_.add(frame);
    if (shows_bar_) draw_bar(frame);
  }

  void calling(const std::string& stage, const std::string& component, const std::string& what,
               std::uint64_t frame) override {
    now_running(stage, component, what, frame);
  }
  void called() override { set_ended(); }

  const RunStatistics& statistics() const { return statistics_; }

  void clear_bar() const {
    if (shows_bar_) fmt::print(stderr, "\r{:78}\r", "");
  }

 private:
  void draw_bar(const FrameResult& frame) const {
    constexpr int kWidth = 40;
    const std::int64_t done = statistics_.frames();
    if (total_ <= 0) {
      fmt::print(stderr, "\r{} frames, {:<40}", done, to_string(frame.state));
      return;
    }
    const auto filled = static_cast<int>(kWidth * done / total_);
    fmt::print(stderr, "\r[{:#<{}}{:.<{}}] {}/{} {:<10}", "", filled, "", kWidth - filled, done,
               total_, to_string(frame.state));
  }

  const RunArguments& arguments_;
  const PipelineConfig& config_;
  bool shows_bar_;
  std::int64_t total_ = -1;  ///< [frames] -1 when unknown
  RunStatistics statistics_;
};

/// Where the words of a run go: not to where a component of it writes.
std::FILE* words_beside(const PipelineConfig& config) {
  const auto outputs = declared_paths(config, WEFT_VALUE_OUTPUT_PATH, "/");
  const bool taken = std::any_of(outputs.begin(), outputs.end(), [](const DeclaredPath& output) {
    return output.path == "/dev/stdout";
  });
  return taken ? stderr : stdout;
}

void print_interrupted(std::FILE* words) {
  fmt::print(words, "interrupted before the first frame was finished: no run folder is left\n");
}

/// With `folder` as the run folder.
std::pair<CheckedPipeline, ConfigReport> check(const RunArguments& arguments,
                                               const std::string& folder,
                                               const host::Registry& registry,
                                               host::ComponentChecks& checks) {
  const std::string absolute = fs::absolute(folder).string();
  auto document = read_document(arguments.pipeline, arguments.settings, registry,
                                host::PathRules::of_process({}, absolute), arguments.patches);
  // A component must run in this process to be named when it writes into its inputs.
  const bool stays = arguments.paranoid && arguments.isolate == "auto";
  document.isolating = stays ? Isolating::preferred : isolating_of(arguments.isolate);
  return check_pipeline(arguments.pipeline, std::move(document), registry, absolute, &checks);
}

/// A run folder and the checked pipeline that writes there.
struct Prepared {
  std::string folder;
  CheckedPipeline pipeline;
  ConfigReport report;
};

/// `claimed` keeps a folder without a given name from other runs.
Prepared prepare(const RunArguments& arguments, const host::Registry& registry,
                 ClaimedFolder& claimed) {
  host::ComponentChecks checks = checks_of(arguments.pipeline);
  Prepared made;
  const bool is_named = !arguments.folder.empty();
  made.folder = is_named ? arguments.folder : free_folder(arguments.pipeline);
  std::tie(made.pipeline, made.report) = check(arguments, made.folder, registry, checks);
  // Runs that start together must not choose the same folder.
  while (made.report.ok() && !is_named && !claimed.take(made.folder)) {
    made.folder = free_folder(arguments.pipeline);
    std::tie(made.pipeline, made.report) = check(arguments, made.folder, registry, checks);
  }
  for (const std::string& doubt : arguments.doubts) made.pipeline.config.doubts.push_back(doubt);
  return made;
}

/// Those of the pipeline file begin with their place.
void print_warnings(const RunSummary& summary) {
  for (const RunWarning& warning : summary.warnings) {
    const bool is_of_frames = warning.frames > 0;  // else it came before them
    fmt::print(
        stderr, "warning: {}: {}{}\n{}", warning.component, warning.text,
        is_of_frames ? fmt::format(" ({} of {} frames)", warning.frames, summary.frames) : "",
        is_of_frames ? "" : source_excerpt(warning.text));
  }
}

void print_end(const RunSummary& summary, bool drops, std::FILE* words) {
  fmt::print(words, "{} frames{}, {} failed{}{}: {}\n", summary.frames,
             drops ? fmt::format(", {} dropped", summary.dropped) : "", summary.failed,
             summary.warnings.empty() ? "" : fmt::format(", {} warned", summary.warnings.size()),
             summary.stopped ? ", stopped early" : "", summary.folder);
  if (summary.late_in.empty()) return;
  std::string stages;
  for (const auto& [stage, frames] : summary.late_in) {
    stages += fmt::format("{}{} in {}", stages.empty() ? "" : ", ", frames, stage);
  }
  fmt::print(words, "frames over budget_ms, by the stage in which it passed: {}\n", stages);
}

}  // namespace

RunCounts run(const RunArguments& arguments, Context& context) {
  const std::atomic<bool>& interrupted = watch_for_interruption();
  std::optional<RecordedRun> repeated;
  if (!arguments.repeated.empty()) {
    auto recorded = recorded_run(arguments.repeated);
    if (!recorded) {
      print_error(recorded.error());
      context.exit_code = kBadConfiguration;
      return {};
    }
    repeated = *std::move(recorded);
  }
  const auto registry = context.registry();
  ClaimedFolder claimed;
  const Prepared prepared = prepare(arguments, registry, claimed);
  const PipelineConfig& config = prepared.pipeline.config;
  if (!prepared.report.ok() && interrupted.load()) {
    print_interrupted(stdout);
    return {};
  }
  if (!prepared.report.ok()) {
    print_report(prepared.report);
    if (arguments.refused) arguments.refused(prepared.report);
    context.exit_code = kBadConfiguration;
    return {};
  }
  std::FILE* const words = words_beside(config);
  Progress progress(arguments, config);
  const std::string isolation = words_on_isolation(config);
  if (!isolation.empty() && arguments.isolate == "auto" && !arguments.quiet) {
    fmt::print(stderr, "{}\n", isolation);
  }
  const auto summary = run_pipeline(prepared.pipeline, prepared.folder, progress, interrupted,
                                    {.dumped = arguments.dumped,
                                     .registry = &registry,
                                     .repeated = std::move(repeated),
                                     .keeps_records = arguments.keeps_records,
                                     .restarts = arguments.restarts,
                                     .protects_inputs = arguments.paranoid});
  now_running("the summary");
  progress.clear_bar();
  if (!summary) {
    print_error(summary.error());
    const bool io = summary.error().code == Errc::io;
    context.exit_code = io ? kInputOutput : kBadConfiguration;
    if (arguments.failed) arguments.failed(config, summary.error());
    return {};
  }
  if (summary->cancelled && summary->frames == 0) {
    print_interrupted(words);
    return {};
  }
  if (!arguments.quiet) progress.statistics().print(words);
  print_warnings(*summary);
  print_end(*summary, config.latest_only, words);
  const bool gave_up = config.stop_on_error && summary->failed > 0;
  if (gave_up || summary->failed > config.max_failed) context.exit_code = kFramesFailed;
  RunCounts counts = progress.statistics().counts();
  counts.restart = summary->restart;
  return counts;
}

}  // namespace weft::cli
