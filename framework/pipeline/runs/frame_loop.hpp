// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "pipeline/execution/input.hpp"
#include "pipeline/monitor/setup_monitor.hpp"
#include "pipeline/runs/run.hpp"

namespace weft {

/// The maximum number of frames in the stages of a run. Without a setting there are two if two
/// threads can work, because results are the same and a run takes less time. There is one if the
/// newest frame counts or a user steers the run, because two compete for the processor.
int frames_at_once_of(const PipelineConfig& config);

/// How many frames of a run are worked on at the same moment.
int workers_of(const PipelineConfig& config);

/// An execution context for the components of a pipeline. Uses shared memory if a stage runs in a
/// separate process, with the threads that the workers leave to each call.
Result<std::unique_ptr<host::ExecutionContext>> context_of(const PipelineConfig& config,
                                                           host::ExecutionContext::Log log);

/// A frame between the source and its line.
struct FrameOnItsWay {
  PipelineInput::Frame read;
  FrameResult result;  ///< the report of the source comes first, from the end of the stages on
};

/// A step of a frame of a run.
struct FrameStep {
  enum class Kind { read, stage, end, sink, file };
  Kind kind;
  std::size_t index = 0;  ///< index of the stage or the sink
  StepRule rule{};
};

/// A line for frames that take these steps.
FrameLine line_of(const std::vector<FrameStep>& steps, std::size_t frames_at_once);

/// An opened pipeline, frame by frame: what a run does with a frame before it is filed.
class FrameLoop {
 public:
  /// Opens source and template and makes the stages; pipeline and execution context outlive the
  /// loop. With a camera frames are handed in, see PipelineInput.
  static Result<std::unique_ptr<FrameLoop>> open(const CheckedPipeline& pipeline,
                                                 host::ExecutionContext& context,
                                                 host::RecordPtr camera = nullptr);

  /// Makes and opens the sinks, in their order; the first error ends it. From then on no stop
  /// request reaches them: a frame that is there is written by all sinks, or by none.
  Result<void> open_sinks();

  /// The sinks at which clients may steer the run.
  std::vector<const host::Instance*> steering_sinks() const;

  /// Sinks of frames that begin from now on receive these.
  void set_settings(std::string json);

  PipelineInput& input() { return input_; }
  Executor& executor() { return *executor_; }

  /// Evidence of the frames about the set-up until now.
  std::vector<RunWarning> warnings() const;
  std::vector<std::pair<std::string, double>> camera() const;

  /// A frame that no stage has seen.
  FrameOnItsWay begin(PipelineInput::Frame read);

  /// All steps of a frame in their order: it is read, goes through each stage, ends and is settled,
  /// goes to each sink, is filed. Steps of several frames may overlap according to their rules.
  std::vector<FrameStep> steps() const;

  /// A stage, the end or a sink; the thread that drives the loop reads and files frames.
  void take(const FrameStep& step, FrameOnItsWay& frame);

  /// `begin`, all stages and the end.
  FrameResult process(const PipelineInput::Frame& read);

  /// Shows the frame to the sinks, whose reports are added.
  void finish(FrameResult& result);

  /// The next frame is the first of a sequence, see Executor::restart().
  void restart();

  /// Finishes all sinks, whatever one of them returns; the first error counts. An interrupt that
  /// cut one short is no error.
  Result<void> close_sinks();

 private:
  struct Sink {
    host::SharedText name;
    const Node* node;
    host::Instance* instance;
  };

  FrameLoop(const CheckedPipeline& pipeline, host::ExecutionContext& context, PipelineInput input)
      : pipeline_(pipeline), context_(context), input_(std::move(input)) {}
  void watch_set_up();
  void end(FrameOnItsWay& frame);
  StageReport write(const Sink& sink, const FrameResult& result);
  std::optional<std::size_t> value_for_sinks(std::string_view slot) const;

  const CheckedPipeline& pipeline_;
  host::ExecutionContext& context_;
  PipelineInput input_;
  std::unique_ptr<Executor> executor_;
  std::optional<SetupMonitor> monitor_;
  std::vector<Sink> sinks_;
  std::optional<std::size_t> report_, settings_;  ///< the values of these, where a sink reads them
  host::RecordPtr now_set_;
};

}  // namespace weft
