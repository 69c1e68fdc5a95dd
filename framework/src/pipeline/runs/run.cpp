// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/run.hpp"

#include <algorithm>
#include <set>

#include "pipeline/execution/input.hpp"
#include "pipeline/monitor/setup_monitor.hpp"
#include "pipeline/runs/dump.hpp"
#include "pipeline/runs/run_folder.hpp"
#include "pipeline/runs/trace.hpp"
#include "roles/role_rules.hpp"

namespace weft {
namespace {

using host::Outcome;
using host::RecordPtr;

struct Failed {
  Error error;
};

/// The value of a Result, or an exception that ends run_pipeline with its error.
template <class T>
T need(Result<T> result) {
  if (!result) throw Failed{result.error()};
  return *std::move(result);
}
void need(const Result<void>& result) {
  if (!result) throw Failed{result.error()};
}

/// Where records stand when another process is to read them.
std::shared_ptr<host::SharedArena> arena_for(const PipelineConfig& config) {
  const bool isolated = std::any_of(config.stages.begin(), config.stages.end(),
                                    [](const StageConfig& stage) { return stage.isolation; });
  return isolated ? need(host::SharedArena::create()) : nullptr;
}

/// Counts what components warn of, each text once a frame.
class WarningLog {
 public:
  void begin_frame() { told_.clear(); }
  void end_of_start() { in_frames_ = true; }

  void note(const std::string& component, int level, const std::string& text) {
    constexpr int kWarning = 2;
    constexpr std::size_t kMost = 100;
    if (level < kWarning || !told_.emplace(component, text).second) return;
    const auto same = [&](const RunWarning& warning) {
      return warning.component == component && warning.text == text;
    };
    auto known = std::find_if(warnings_.begin(), warnings_.end(), same);
    if (known == warnings_.end()) {
      if (warnings_.size() == kMost) return;
      known = warnings_.insert(known, {component, text, 0});
    }
    known->frames += in_frames_ ? 1 : 0;
  }

  std::vector<RunWarning> take() { return std::move(warnings_); }

 private:
  bool in_frames_ = false;
  std::set<std::pair<std::string, std::string>> told_;  ///< in this frame
  std::vector<RunWarning> warnings_;
};

class Run {
 public:
  Run(const CheckedPipeline& pipeline, const std::string& folder, RunObserver& observer,
      const std::atomic<bool>& cancel, const std::vector<std::string>& dumped)
      : config_(pipeline.config),
        graph_(pipeline.graph),
        observer_(observer),
        cancel_(cancel),
        dumped_(dumped),
        lane_(
            pipeline.config.seed,
            [this](const std::string& component, int level, const std::string& text) {
              warnings_.note(component, level, text);
            },
            arena_for(pipeline.config)),
        folder_path_(folder) {
    watch();
    lane_.announce_to([this](const std::string& stage, const std::string& what,
                             std::uint64_t frame) { observer_.calling(stage, what, frame); });
  }

  RunSummary run() {
    try {
      open();
      const std::int64_t count = input_->frames();
      observer_.started(count);
      warnings_.end_of_start();
      for (std::int64_t index = 0; count < 0 || index < count; ++index) {
        if (cancel_.load() || !frame(static_cast<std::uint64_t>(index))) break;
      }
    } catch (const Failed& failed) {
      static_cast<void>(finish());  // the first error is the one to report
      if (failed.error.code != Errc::cancelled || !cancel_.load()) throw;
      return summary();
    }
    need(finish());
    return summary();
  }

 private:
  /// A run that was cancelled before its first frame was there leaves nothing of itself.
  RunSummary summary() {
    summary_.cancelled = cancel_.load();
    summary_.stopped = summary_.stopped || summary_.cancelled;
    summary_.warnings = warnings_.take();
    if (monitor_) {
      for (RunWarning& warning : monitor_->warnings()) {
        summary_.warnings.push_back(std::move(warning));
      }
    }
    if (folder_ && summary_.cancelled && summary_.frames == 0) {
      trace_.reset();
      folder_->withdraw();
      folder_.reset();
    }
    if (folder_) {
      need(folder_->end(summary_.frames, summary_.failed, summary_.stopped));
      summary_.folder = folder_->path();
    }
    return summary_;
  }

  struct Sink {
    const StageConfig* config;
    const Node* node;
    host::Instance* instance;
  };

  void open() {
    need(Dump::check_names(config_, dumped_));
    input_.emplace(need(PipelineInput::open(config_, lane_)));
    executor_ = need(Executor::create(config_, graph_, lane_, input_->templ(), input_->camera()));
    // A mesh that is no surface has no lengths to judge by: such a run is not watched.
    if (auto made = SetupMonitor::create(*input_->templ(), input_->camera())) {
      monitor_.emplace(*std::move(made));
    }
    stop_if_cancelled();
    // Not before: a run that cannot start leaves no folder behind.
    if (!folder_path_.empty()) open_folder();
    open_sinks();
    if (trace_) need(trace_->add(lane_.take_timings()));
  }

  void watch() {
    lane_.watch([this] { return cancel_.load(); });
  }

  void stop_if_cancelled() const {
    if (cancel_.load()) throw Failed{{Errc::cancelled, "cancelled before the first frame", {}}};
  }

  void open_folder() {
    const RecordPtr &templ = input_->templ(), &camera = input_->camera();
    folder_.emplace(need(RunFolder::create(folder_path_)));
    need(folder_->begin(config_, *templ, *camera));
    trace_.emplace(need(Trace::create(folder_->path() + "/trace.json")));
    dump_.emplace(need(Dump::create(folder_->path(), config_, dumped_, templ, camera)));
    for (const std::string& stage : dumped_) executor_->keep_calls_of(stage);
  }

  void open_sinks() {
    for (std::size_t i = 0; i < config_.sinks.size(); ++i) {
      const StageConfig& sink = config_.sinks[i];
      host::Instance* instance = need(lane_.instantiate(sink.component, sink.name));
      need(lane_.prepare(*instance, *input_->templ(), *input_->camera()));
      const Outcome opened = lane_.call(*instance, kOpenSink, {}, host::kOfflineFrame);
      if (!opened.usable()) throw Failed{opened.error};
      sinks_.push_back({&sink, &graph_.sinks[i], instance});
    }
  }

  /// False when the run ends here.
  bool frame(std::uint64_t index) {
    warnings_.begin_frame();
    const auto read = input_->read(index);
    if (!read) return false;
    FrameResult result = executor_->process(read->input);
    result.stages.insert(result.stages.begin(), read->report);
    if (result.failed() && cancel_.load()) return false;  // cut short: this is no result
    if (monitor_) monitor_->add(graph_, result);
    lane_.watch(nullptr);  // a frame that is there is written by all sinks, or by none
    for (const Sink& sink : sinks_) result.stages.push_back(write(sink, result));
    watch();
    for (const host::Timing& timing : lane_.take_timings()) result.timings.push_back(timing);
    if (folder_) {
      need(folder_->add(graph_, result, read->input.find("ground_truth")));
      need(trace_->add(result));
      need(dump_->add(result));
    }
    ++summary_.frames;
    summary_.failed += result.failed() ? 1 : 0;
    observer_.frame_done(result);
    summary_.stopped = result.failed() && config_.stop_on_error;
    return !summary_.stopped;
  }

  StageReport write(const Sink& sink, const FrameResult& result) {
    std::vector<weft_record> inputs;
    const std::string cause = gather(*sink.node, result, inputs);
    if (!cause.empty()) return {sink.config->name, StageStatus::skipped, cause, {}, {}, false};
    const host::Stopwatch watch;
    const Outcome outcome = lane_.call(*sink.instance, kWriteFrame, inputs, result.index);
    return report_of(sink.config->name, outcome, watch.spent());
  }

  /// Finishes sinks and trace; the first error counts.
  Result<void> finish() {
    Result<void> status = close_sinks();
    if (!trace_) return status;
    for (const auto& written : {trace_->add(lane_.take_timings()), trace_->close()}) {
      if (status && !written) status = written;
    }
    return status;
  }

  /// Finishes all sinks, whatever one of them says; the first error counts.
  Result<void> close_sinks() {
    lane_.watch(nullptr);  // what was written so far is finished also when the run was cancelled
    Result<void> status;
    for (const Sink& sink : sinks_) {
      const Outcome closed = lane_.call(*sink.instance, kFinishSink, {}, host::kOfflineFrame);
      if (!closed.usable() && status) {
        status = Error{Errc::io, closed.error.message, closed.error.where};
      }
    }
    return status;
  }

  const PipelineConfig& config_;
  const Graph& graph_;
  RunObserver& observer_;
  const std::atomic<bool>& cancel_;
  const std::vector<std::string>& dumped_;  ///< names of stages
  WarningLog warnings_;
  host::Lane lane_;
  std::string folder_path_;
  std::optional<RunFolder> folder_;
  std::optional<Trace> trace_;
  std::optional<Dump> dump_;
  std::optional<PipelineInput> input_;
  std::unique_ptr<Executor> executor_;
  std::optional<SetupMonitor> monitor_;
  std::vector<Sink> sinks_;
  RunSummary summary_;
};

}  // namespace

Result<RunSummary> run_pipeline(const CheckedPipeline& pipeline, const std::string& output_folder,
                                RunObserver& observer, const std::atomic<bool>& cancel,
                                const std::vector<std::string>& dumped) {
  try {
    return Run(pipeline, output_folder, observer, cancel, dumped).run();
  } catch (const Failed& failed) {
    return failed.error;
  }
}

}  // namespace weft
