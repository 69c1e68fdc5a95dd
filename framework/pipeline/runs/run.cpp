// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/run.hpp"

#include <algorithm>
#include <mutex>
#include <weft/core/index.hpp>

#include "pipeline/runs/frame_supply.hpp"
#include "pipeline/runs/frame_writer.hpp"
#include "pipeline/runs/run_recorder.hpp"
#include "pipeline/runs/warning_log.hpp"

namespace weft {
namespace {

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

class Run {
 public:
  Run(const CheckedPipeline& pipeline, const std::string& folder, RunObserver& observer,
      const std::atomic<bool>& cancel, RunOptions options)
      : pipeline_(pipeline),
        observer_(observer),
        cancel_(cancel),
        options_(std::move(options)),
        context_(need(context_of(
            pipeline.config,
            [this](const std::string& component, int level, const std::string& text,
                   std::uint64_t frame) { warnings_.note(component, level, text, frame); }))),
        folder_path_(folder) {
    if (options_.protects_inputs) context_->protect_inputs();
    context_->cancellation().watch([this] { return cancel_.load(); });
    context_->announce_to(
        [this](const std::string& stage, const std::string& component, const std::string& what,
               std::uint64_t frame) {
          const std::lock_guard lock(announcing_);
          observer_.calling(stage, component, what, frame);
        },
        [this] {
          const std::lock_guard lock(announcing_);
          observer_.called();
        });
  }

  RunSummary run() {
    try {
      open();
      // The number of frames of a run that drops some is unknown.
      observer_.started(pipeline_.config.latest_only ? -1 : loop_->input().frames());
      take_all_frames();
    } catch (const Failed& failed) {
      static_cast<void>(finish());  // the first error is the one to report
      // An interrupt before the frames may look like any failure of a component; later ones are
      // reported.
      const bool is_of_interrupt = is_open_ ? failed.error.code == Errc::cancelled : true;
      if (cancel_.load() && is_of_interrupt) return summary();
      if (!is_open_) withdraw();
      throw;
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
      summary_.camera = loop_->camera();
    }
    if (summary_.cancelled && summary_.frames == 0) withdraw();
    if (recorder_) {
      need(recorder_->end(summary_));
      summary_.folder = recorder_->folder();
    }
    return summary_;
  }

  /// Otherwise the next try would find its folder taken.
  void withdraw() {
    if (!recorder_) return;
    recorder_->withdraw();
    recorder_.reset();
  }

  void open() {
    need(Dump::check_names(pipeline_.config, options_.dumped));
    for (const std::string& doubt : pipeline_.config.doubts) context_->warn("pipeline", doubt);
    loop_ = need(FrameLoop::open(pipeline_, *context_));
    stop_if_cancelled();
    supply_ = supply();
    // A run that cannot start leaves no folder behind.
    if (!folder_path_.empty()) open_folder();
    need(loop_->open_sinks());
    open_steering();
    if (recorder_) need(recorder_->add(context_->times().take()));
    is_open_ = true;
  }

  void stop_if_cancelled() const {
    if (cancel_.load()) throw Failed{{Errc::cancelled, "cancelled before the first frame", {}}};
  }

  std::unique_ptr<FrameSupply> supply() {
    PipelineInput& input = loop_->input();
    if (options_.repeated) return need(repeated_frames(*options_.repeated, input, *context_));
    if (!pipeline_.config.latest_only) return all_frames(input);
    const auto drop = [this](std::uint64_t index) {
      context_->times().take(index);
      warnings_.forget(index);
    };
    return newest_frames(
        input, *context_, options_.clock != nullptr ? *options_.clock : clock_of_machine_,
        [this] { return cancel_.load(); }, drop);
  }

  void open_folder() {
    recorder_.emplace(need(RunRecorder::create(folder_path_, pipeline_, loop_->input(),
                                               options_.dumped, options_.keeps_records)));
    for (const std::string& stage : options_.dumped) loop_->executor().keep_calls_of(stage);
  }

  void open_steering() {
    std::vector<const host::Instance*> sinks = loop_->steering_sinks();
    if (options_.registry == nullptr || !recorder_) return;
    if (sinks.empty() && !options_.repeated) return;
    const auto check = [this](const std::vector<std::string>& settings) {
      return check_change(pipeline_.config, recorder_->folder(), *options_.registry, settings);
    };
    const StageMaker maker{*context_, loop_->input().templ(), loop_->input().camera()};
    steering_ = std::make_unique<Steering>(
        ChangeMaker(pipeline_, maker, check), loop_->executor(), std::move(sinks),
        options_.repeated ? options_.repeated->changes : ChangesByFrame(), recorder_->folder(),
        options_.restarts);
  }

  void take_all_frames() {
    std::vector<FrameStep> steps = loop_->steps();
    // The newest frame is taken when it can go on, and grows old nowhere.
    if (pipeline_.config.latest_only) steps.front().rule.busy_for = 1;
    const auto at_once = to_index(frames_at_once_of(pipeline_.config));
    on_their_way_.resize(at_once);
    FrameLine line = line_of(steps, at_once);
    start_threads(at_once);
    std::exception_ptr failure;
    try {
      line.run(workers_of(pipeline_.config),
               [&](std::size_t step, std::uint64_t place) { return take(steps[step], place); });
    } catch (...) {
      failure = std::current_exception();
    }
    supply_->stop();
    if (steering_) {
      summary_.stopped = summary_.stopped || steering_->has_ended();
      summary_.restart = steering_->restart();
    }
    steering_.reset();
    context_->times().count(context_->times().counted());
    if (writer_) writer_->close();  // its own failure follows from that of an earlier frame
    if (failure) std::rethrow_exception(failure);
  }

  /// Starts the threads that read and write beside the frames on their way.
  void start_threads(std::size_t at_once) {
    if (recorder_) {
      writer_ = std::make_unique<FrameWriter>(at_once, [this](FrameOnItsWay& f) { keep(f); });
      context_->times().count(context_->times().counted(), writer_->processor_clock());
    }
    supply_->start();
  }

  FrameLine::Answer take(const FrameStep& step, std::uint64_t place) {
    using Kind = FrameStep::Kind;
    using enum FrameLine::Answer;
    std::optional<FrameOnItsWay>& frame = on_their_way_[place % on_their_way_.size()];
    if (step.kind == Kind::read) return read(place, frame) ? passed : not_there;
    if (step.kind == Kind::end && frame->result.failed() && cancel_.load()) {
      return not_there;  // cut short: this is no result
    }
    if (step.kind != Kind::file) {
      loop_->take(step, *frame);
      return passed;
    }
    const auto& reports = frame->result.stages;
    const auto is_cut = [&](const StageReport& report) {
      return report.code == Errc::cancelled && is_cut_short(report);
    };
    if (std::any_of(reports.begin(), reports.end(), is_cut)) return not_there;
    FrameOnItsWay through = std::move(*frame);
    frame.reset();
    return file(std::move(through)) ? passed : last;
  }

  /// An interrupted call, whatever its status, has failed for no fault of the frame.
  bool is_cut_short(const StageReport& report) const {
    return report.status == StageStatus::error && cancel_.load();
  }

  /// False where there is no such frame, or none is wanted.
  bool read(std::uint64_t place, std::optional<FrameOnItsWay>& frame) {
    if (cancel_.load() || !supply_->has(place)) return false;
    if (steering_ && !steering_->wait_for_turn([this] { return cancel_.load(); })) return false;
    auto read = supply_->take(place);
    if (!read || is_cut_short(read->report)) return false;
    if (steering_) {
      if (auto settings = need(steering_->change(read->input.index))) {
        loop_->set_settings(*std::move(settings));
      }
    }
    frame.emplace(loop_->begin(*std::move(read)));
    if (steering_) steering_->note(frame->result);
    return true;
  }

  /// False when the run ends here.
  bool file(FrameOnItsWay frame) {
    FrameResult& result = frame.result;
    for (const host::Timing& timing : context_->times().take(result.index)) {
      result.timings.push_back(timing);
    }
    const bool stops = result.failed() && pipeline_.config.stop_on_error;
    summary_.stopped = summary_.stopped || stops;
    if (writer_) return writer_->put(std::move(frame)) && !stops;
    keep(frame);
    return !stops;
  }

  /// Frame by frame, in their order.
  void keep(const FrameOnItsWay& frame) {
    const FrameResult& result = frame.result;
    if (recorder_) need(recorder_->add(frame));
    warnings_.file(result.index);
    ++summary_.frames;
    summary_.dropped += static_cast<std::int64_t>(result.dropped_before);
    summary_.failed += result.failed() ? 1 : 0;
    if (!result.late_in.empty()) ++summary_.late_in[result.late_in.str()];
    observer_.frame_done(result);
  }

  /// Closes sinks and trace; the first error counts.
  Result<void> finish() {
    Result<void> status = loop_ ? loop_->close_sinks() : Result<void>();
    if (!recorder_) return status;
    for (const auto& written :
         {recorder_->add(context_->times().take()), recorder_->close_trace()}) {
      if (status && !written) status = written;
    }
    return status;
  }

  const CheckedPipeline& pipeline_;
  RunObserver& observer_;
  const std::atomic<bool>& cancel_;
  RunOptions options_;
  SteadyClock clock_of_machine_;
  WarningLog warnings_;
  std::mutex announcing_;
  std::unique_ptr<host::ExecutionContext> context_;
  std::string folder_path_;
  bool is_open_ = false;                 ///< all that comes before the first frame is done
  std::optional<RunRecorder> recorder_;  ///< where the run has a folder
  std::unique_ptr<FrameLoop> loop_;      ///< from open() on, as the supply
  std::unique_ptr<FrameSupply> supply_;
  std::vector<std::optional<FrameOnItsWay>> on_their_way_;  ///< by frame, modulo their number
  RunSummary summary_;                   ///< its counts of frames belong to the caller that keeps
                                         ///< the frames
  std::unique_ptr<FrameWriter> writer_;  ///< where the run has a folder
  std::unique_ptr<Steering> steering_;   ///< where sinks may change the run
};

}  // namespace

Result<RunSummary> run_pipeline(const CheckedPipeline& pipeline, const std::string& output_folder,
                                RunObserver& observer, const std::atomic<bool>& cancel,
                                RunOptions options) {
  try {
    return Run(pipeline, output_folder, observer, cancel, std::move(options)).run();
  } catch (const Failed& failed) {
    return placed(failed.error, pipeline.config);
  }
}

}  // namespace weft
