// SPDX-License-Identifier: Apache-2.0
#include "cli/run/running.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <tuple>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

#include "cli/output/report_text.hpp"
#include "cli/run/interruption.hpp"
#include "cli/run/recorded_run.hpp"
#include "cli/run/run_settings.hpp"
#include "pipeline/configuration/declared_paths.hpp"
#include "pipeline/runs/run.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

/// Progress on the terminal and what the summary needs.
class Progress final : public RunObserver {
 public:
  Progress(const RunArguments& arguments, const PipelineConfig& config, std::FILE* words)
      : arguments_(arguments),
        config_(config),
        show_bar_(!arguments.quiet && isatty(STDERR_FILENO) != 0),
        words_(words) {}

  void started(std::int64_t frames) override {
    total_ = frames;
    if (arguments_.started) arguments_.started(config_);
  }

  void frame_done(const FrameResult& frame) override {
    ++done_;
    ++states_[to_string(frame.state)];
    if (frame.state == ShapeState::estimated || frame.state == ShapeState::weak) {
      if (const auto shape = host::view_as<Shape>(*frame.shape)) {
        confidences_.push_back(shape->confidence);
      }
    }
    for (const StageReport& report : frame.stages) {
      if (stages_.count(report.stage) == 0) order_.push_back(report.stage);
      Stage& stage = stages_[report.stage];
      ++stage.statuses[to_index(report.status)];
      if (report.status != StageStatus::skipped) stage.spent(report.took);
      const bool first_error = stage.first_error.empty();
      if (report.status == StageStatus::error && first_error) {
        stage.first_error =
            fmt::format("frame {} ({}): {}", frame.index, frame.stem, report.reason.str());
      }
    }
    if (show_bar_) draw_bar(frame);
  }

  void calling(const std::string& stage, const std::string& component, const std::string& what,
               std::uint64_t frame) override {
    now_running(stage, component, what, frame);
  }

  RunCounts counts() const {
    const auto in_state = [&](ShapeState state) {
      const auto found = states_.find(to_string(state));
      return found == states_.end() ? 0 : found->second;
    };
    return {done_, in_state(ShapeState::estimated), in_state(ShapeState::weak)};
  }

  void clear_bar() const {
    if (show_bar_) fmt::print(stderr, "\r{:78}\r", "");
  }

  void print_table() const {
    clear_bar();
    fmt::print(words_, "{:<16}{:>7}{:>12}{:>11}{:>9}{:>7}{:>9}{:>9}{:>9}\n", "stage", "ok",
               "degenerate", "no_result", "skipped", "error", "ms p50", "ms p95", "cpu p50");
    for (const std::string& name : order_) {
      const Stage& stage = stages_.at(name);
      const auto count = [&](StageStatus status) { return stage.statuses[to_index(status)]; };
      fmt::print(words_, "{:<16}{:>7}{:>12}{:>11}{:>9}{:>7}", name, count(StageStatus::ok),
                 count(StageStatus::degenerate), count(StageStatus::no_result),
                 count(StageStatus::skipped), count(StageStatus::error));
      if (stage.ms.empty()) {
        fmt::print(words_, "{:>9}{:>9}{:>9}\n", "-", "-", "-");
      } else {
        fmt::print(words_, "{:>9.2f}{:>9.2f}{:>9.2f}\n", percentile(stage.ms, 50.0),
                   percentile(stage.ms, 95.0), percentile(stage.processor_ms, 50.0));
      }
    }
    fmt::print(words_, "shapes: ");
    for (const char* state : {"estimated", "weak", "predicted", "lost", "none"}) {
      const auto found = states_.find(state);
      if (found != states_.end()) fmt::print(words_, "{} {}  ", found->second, state);
    }
    if (!confidences_.empty()) {
      fmt::print(words_, "confidence {:.2f} in the median, {:.2f} at least", median(confidences_),
                 percentile(confidences_, 0.0));
    }
    fmt::print(words_, "\n");
    for (const std::string& name : order_) {
      const std::string& error = stages_.at(name).first_error;
      if (!error.empty()) fmt::print(words_, "first error of {}: {}\n", name, error);
    }
  }

 private:
  struct Stage {
    std::array<int, 5> statuses{};
    std::vector<double> ms, processor_ms;  ///< one a frame in which it was not skipped
    std::string first_error;

    void spent(const host::Spent& took) {
      ms.push_back(took.ms);
      processor_ms.push_back(took.processor_ms);
    }
  };

  void draw_bar(const FrameResult& frame) const {
    constexpr int kWidth = 40;
    if (total_ <= 0) {
      fmt::print(stderr, "\r{} frames, {:<40}", done_, to_string(frame.state));
      return;
    }
    const auto filled = static_cast<int>(kWidth * done_ / total_);
    fmt::print(stderr, "\r[{:#<{}}{:.<{}}] {}/{} {:<10}", "", filled, "", kWidth - filled, done_,
               total_, to_string(frame.state));
  }

  const RunArguments& arguments_;
  const PipelineConfig& config_;
  bool show_bar_;
  std::FILE* words_;  ///< where the table goes
  std::int64_t total_ = -1;
  std::int64_t done_ = 0;
  std::vector<std::string> order_;
  std::map<std::string, Stage> stages_;
  std::map<std::string, int> states_;
  std::vector<double> confidences_;  ///< [] of what was measured
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
  auto document = read_document(arguments.pipeline, arguments.settings,
                                host::PathRules::of_process({}, absolute), arguments.patches);
  // What is to be named when it touches its inputs must be here.
  const bool stays = arguments.paranoid && arguments.isolate == "auto";
  document.isolating = stays ? Isolating::preferred : isolating_of(arguments.isolate);
  return check_pipeline(arguments.pipeline, std::move(document), registry, absolute, &checks);
}

}  // namespace

RunCounts run(const RunArguments& arguments, Context& context) {
  const std::string& file = arguments.pipeline;
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
  host::ComponentChecks checks = checks_of(file);
  ClaimedFolder claimed;
  std::string folder = arguments.folder.empty() ? free_folder(file) : arguments.folder;
  auto [pipeline, report] = check(arguments, folder, registry, checks);
  // Of runs that begin together each gets a folder of its own.
  while (report.ok() && arguments.folder.empty() && !claimed.take(folder)) {
    folder = free_folder(file);
    std::tie(pipeline, report) = check(arguments, folder, registry, checks);
  }
  if (!report.ok() && interrupted.load()) {
    print_interrupted(stdout);
    return {};
  }
  if (!report.ok()) {
    print_report(report);
    if (arguments.refused) arguments.refused(report);
    context.exit_code = kBadConfiguration;
    return {};
  }
  std::FILE* const words = words_beside(pipeline.config);
  Progress progress(arguments, pipeline.config, words);
  const std::string apart = words_on_isolation(pipeline.config);
  if (!apart.empty() && arguments.isolate == "auto" && !arguments.quiet) {
    fmt::print(stderr, "{}\n", apart);
  }
  const auto summary = run_pipeline(pipeline, folder, progress, interrupted,
                                    {.dumped = arguments.dumped,
                                     .registry = &registry,
                                     .repeated = std::move(repeated),
                                     .keeps_records = arguments.keeps_records,
                                     .protects_inputs = arguments.paranoid});
  now_running("the summary");
  if (!summary) {
    print_error(summary.error());
    const bool io = summary.error().code == Errc::io;
    context.exit_code = io ? kInputOutput : kBadConfiguration;
    if (arguments.failed) arguments.failed(pipeline.config, summary.error());
    return {};
  }
  if (summary->cancelled && summary->frames == 0) {
    progress.clear_bar();
    print_interrupted(words);
    return {};
  }
  if (!arguments.quiet) progress.print_table();
  for (const RunWarning& warning : summary->warnings) {
    const bool is_of_frames = warning.frames > 0;  // else it came before them
    fmt::print(
        stderr, "warning: {}: {}{}\n", warning.component, warning.text,
        is_of_frames ? fmt::format(" ({} of {} frames)", warning.frames, summary->frames) : "");
  }
  const bool drops = pipeline.config.latest_only;
  fmt::print(words, "{} frames{}, {} failed{}{}: {}\n", summary->frames,
             drops ? fmt::format(", {} dropped", summary->dropped) : "", summary->failed,
             summary->warnings.empty() ? "" : fmt::format(", {} warned", summary->warnings.size()),
             summary->stopped ? ", stopped early" : "", summary->folder);
  const bool gave_up = pipeline.config.stop_on_error && summary->failed > 0;
  if (gave_up || summary->failed > pipeline.config.max_failed) context.exit_code = kFramesFailed;
  return progress.counts();
}

}  // namespace weft::cli
