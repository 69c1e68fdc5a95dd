// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/run.hpp"

#include <algorithm>
#include <set>

#include "pipeline/configuration/output_paths.hpp"
#include "pipeline/runs/dump.hpp"
#include "pipeline/runs/frame_loop.hpp"
#include "pipeline/runs/run_folder.hpp"
#include "pipeline/runs/trace.hpp"

namespace weft {
namespace {

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
      : pipeline_(pipeline),
        observer_(observer),
        cancel_(cancel),
        dumped_(dumped),
        lane_(
            need(lane_of(pipeline.config,
                         [this](const std::string& component, int level, const std::string& text) {
                           warnings_.note(component, level, text);
                         }))),
        folder_path_(folder) {
    watch();
    lane_->announce_to([this](const std::string& stage, const std::string& what,
                              std::uint64_t frame) { observer_.calling(stage, what, frame); });
  }

  RunSummary run() {
    try {
      open();
      const std::int64_t count = loop_->input().frames();
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
    if (loop_) {
      for (RunWarning& warning : loop_->warnings()) summary_.warnings.push_back(std::move(warning));
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

  void open() {
    need(Dump::check_names(pipeline_.config, dumped_));
    loop_ = need(FrameLoop::open(pipeline_, *lane_));
    stop_if_cancelled();
    // Not before: a run that cannot start leaves no folder behind.
    if (!folder_path_.empty()) open_folder();
    need(loop_->open_sinks());
    if (trace_) need(trace_->add(lane_->take_timings()));
  }

  void watch() {
    lane_->watch([this] { return cancel_.load(); });
  }

  void stop_if_cancelled() const {
    if (cancel_.load()) throw Failed{{Errc::cancelled, "cancelled before the first frame", {}}};
  }

  void open_folder() {
    const RecordPtr &templ = loop_->input().templ(), &camera = loop_->input().camera();
    folder_.emplace(need(RunFolder::create(folder_path_)));
    need(folder_->begin(pipeline_.config, *templ, *camera));
    trace_.emplace(need(Trace::create(folder_->path() + "/trace.json")));
    dump_.emplace(need(Dump::create(folder_->path(), pipeline_.config, dumped_, templ, camera)));
    for (const std::string& stage : dumped_) loop_->executor().keep_calls_of(stage);
  }

  /// False when the run ends here.
  bool frame(std::uint64_t index) {
    warnings_.begin_frame();
    const auto read = loop_->input().read(index);
    if (!read) return false;
    FrameResult result = loop_->process(*read);
    if (result.failed() && cancel_.load()) return false;  // cut short: this is no result
    lane_->watch(nullptr);  // a frame that is there is written by all sinks, or by none
    loop_->finish(result);
    watch();
    if (folder_) {
      need(folder_->add(pipeline_.graph, result, read->input.find("ground_truth")));
      need(trace_->add(result));
      need(dump_->add(result));
    }
    ++summary_.frames;
    summary_.failed += result.failed() ? 1 : 0;
    observer_.frame_done(result);
    summary_.stopped = result.failed() && pipeline_.config.stop_on_error;
    return !summary_.stopped;
  }

  /// Finishes sinks and trace; the first error counts.
  Result<void> finish() {
    lane_->watch(nullptr);  // what was written so far is finished also when the run was cancelled
    Result<void> status = loop_ ? loop_->close_sinks() : Result<void>();
    if (!trace_) return status;
    for (const auto& written : {trace_->add(lane_->take_timings()), trace_->close()}) {
      if (status && !written) status = written;
    }
    return status;
  }

  const CheckedPipeline& pipeline_;
  RunObserver& observer_;
  const std::atomic<bool>& cancel_;
  const std::vector<std::string>& dumped_;  ///< names of stages
  WarningLog warnings_;
  std::unique_ptr<host::Lane> lane_;
  std::string folder_path_;
  std::optional<RunFolder> folder_;
  std::optional<Trace> trace_;
  std::optional<Dump> dump_;
  std::unique_ptr<FrameLoop> loop_;
  RunSummary summary_;
};

/// What the components whose parameters are legal say of them. A stage in a process of its own is
/// not asked: nothing loads its library in this one.
void ask_components(const PipelineConfig& config, host::ComponentChecks& checks,
                    std::vector<yaml::Problem>& problems) {
  std::vector<yaml::Problem> found;
  const auto ask = [&](const host::ComponentSpec& component) { checks.ask(component, found); };
  for (const auto* single : {&config.source, &config.templ}) {
    if (*single) ask((*single)->component);
  }
  for (const auto* list : {&config.stages, &config.sinks}) {
    for (const StageConfig& stage : *list) {
      if (stage.isolation) continue;
      ask(stage.component);
      if (stage.on_template) ask(*stage.on_template);
    }
  }
  for (yaml::Problem& mistake : found) {
    const auto same = [&](const yaml::Problem& other) {
      return other.at == mistake.at && other.message == mistake.message;
    };
    if (std::any_of(problems.begin(), problems.end(), same)) continue;
    problems.push_back(std::move(mistake));
  }
}

}  // namespace

std::pair<CheckedPipeline, ConfigReport> check_pipeline(const std::string& file,
                                                        const host::Registry& registry,
                                                        const std::string& output_folder,
                                                        const std::vector<std::string>& settings,
                                                        const std::vector<Patch>& patches) {
  const auto paths = host::PathRules::of_process({}, output_folder);
  return check_pipeline(file, read_document(file, settings, paths, patches), registry,
                        output_folder);
}

std::pair<CheckedPipeline, ConfigReport> check_pipeline(const std::string& file, Document document,
                                                        const host::Registry& registry,
                                                        const std::string& output_folder,
                                                        host::ComponentChecks* checks) {
  auto [config, report] = load_pipeline(file, std::move(document), registry, output_folder);
  CheckedPipeline pipeline{std::move(config), {}};
  refuse_unsafe_outputs(pipeline.config, registry, output_folder, report.problems);
  host::ComponentChecks own;
  ask_components(pipeline.config, checks != nullptr ? *checks : own, report.problems);
  if (report.wirable) pipeline.graph = wire(pipeline.config, registry, report.problems);
  report.sort();
  return {std::move(pipeline), std::move(report)};
}

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
