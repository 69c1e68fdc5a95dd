// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/run.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <weft/core/index.hpp>

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

/// Counts what components warn of, each text once a frame. Frames may warn in any order: they are
/// counted when they are filed.
class WarningLog {
 public:
  /// From any thread.
  void note(const std::string& component, int level, const std::string& text, std::uint64_t frame) {
    constexpr int kWarning = 2;
    if (level < kWarning) return;
    const std::lock_guard lock(mutex_);
    Told& told = told_[frame];
    const std::pair what{component, text};
    if (std::find(told.begin(), told.end(), what) == told.end()) told.push_back(what);
    if (frame == host::kOfflineFrame) file_told(frame, 0);
  }

  void file(std::uint64_t frame) {
    const std::lock_guard lock(mutex_);
    file_told(frame, 1);
  }

  std::vector<RunWarning> take() { return std::move(warnings_); }

 private:
  using Told = std::vector<std::pair<std::string, std::string>>;  ///< component, text

  void file_told(std::uint64_t frame, std::int64_t frames) {
    constexpr std::size_t kMost = 100;
    for (const auto& [component, text] : std::exchange(told_[frame], {})) {
      const auto same = [&, &by = component, &said = text](const RunWarning& warning) {
        return warning.component == by && warning.text == said;
      };
      auto known = std::find_if(warnings_.begin(), warnings_.end(), same);
      if (known == warnings_.end()) {
        if (warnings_.size() == kMost) continue;
        known = warnings_.insert(known, {component, text, 0});
      }
      known->frames += frames;
    }
    told_.erase(frame);
  }

  std::mutex mutex_;
  std::map<std::uint64_t, Told> told_;  ///< by frame, not yet filed
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
        lane_(need(lane_of(
            pipeline.config,
            [this](const std::string& component, int level, const std::string& text,
                   std::uint64_t frame) { warnings_.note(component, level, text, frame); }))),
        folder_path_(folder) {
    lane_->watch([this] { return cancel_.load(); });
    lane_->announce_to(
        [this](const std::string& stage, const std::string& what, std::uint64_t frame) {
          const std::lock_guard lock(announcing_);
          observer_.calling(stage, what, frame);
        });
  }

  RunSummary run() {
    try {
      open();
      observer_.started(loop_->input().frames());
      take_all_frames();
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

  void take_all_frames() {
    const std::vector<FrameStep> steps = loop_->steps();
    std::vector<StepRule> rules;
    std::size_t settled = 0;
    for (const FrameStep& step : steps) {
      if (step.kind == FrameStep::Kind::end) settled = rules.size();
      rules.push_back(step.rule);
    }
    const auto at_once = to_index(pipeline_.config.frames_at_once);
    on_their_way_.resize(at_once);
    FrameLine line(std::move(rules), settled, at_once);
    line.run(workers_of(pipeline_.config),
             [&](std::size_t step, std::uint64_t index) { return take(steps[step], index); });
  }

  FrameLine::Answer take(const FrameStep& step, std::uint64_t index) {
    using Kind = FrameStep::Kind;
    using enum FrameLine::Answer;
    std::optional<FrameOnItsWay>& frame = on_their_way_[index % on_their_way_.size()];
    if (step.kind == Kind::read) return read(index, frame) ? passed : not_there;
    if (step.kind == Kind::end && frame->result.failed() && cancel_.load()) {
      return not_there;  // cut short: this is no result
    }
    if (step.kind != Kind::file) {
      loop_->take(step, *frame);
      return passed;
    }
    const bool goes_on = file(*frame);
    frame.reset();
    return goes_on ? passed : last;
  }

  /// False where there is no such frame, or none is wanted.
  bool read(std::uint64_t index, std::optional<FrameOnItsWay>& frame) {
    const std::int64_t count = loop_->input().frames();
    if (cancel_.load() || (count >= 0 && index >= static_cast<std::uint64_t>(count))) return false;
    auto read = loop_->input().read(index);
    if (!read) return false;
    frame.emplace(loop_->begin(*std::move(read)));
    return true;
  }

  /// False when the run ends here.
  bool file(FrameOnItsWay& frame) {
    FrameResult& result = frame.result;
    for (const host::Timing& timing : lane_->take_timings(result.index)) {
      result.timings.push_back(timing);
    }
    if (folder_) {
      need(folder_->add(pipeline_.graph, result, frame.read.input.find("ground_truth")));
      need(trace_->add(result));
      need(dump_->add(result));
    }
    warnings_.file(result.index);
    ++summary_.frames;
    summary_.failed += result.failed() ? 1 : 0;
    observer_.frame_done(result);
    summary_.stopped = result.failed() && pipeline_.config.stop_on_error;
    return !summary_.stopped;
  }

  /// Finishes sinks and trace; the first error counts.
  Result<void> finish() {
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
  std::mutex announcing_;
  std::unique_ptr<host::Lane> lane_;
  std::string folder_path_;
  std::optional<RunFolder> folder_;
  std::optional<Trace> trace_;
  std::optional<Dump> dump_;
  std::unique_ptr<FrameLoop> loop_;
  std::vector<std::optional<FrameOnItsWay>> on_their_way_;  ///< by frame, modulo their number
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
