// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "pipeline/execution/input.hpp"
#include "pipeline/monitor/setup_monitor.hpp"
#include "pipeline/runs/run.hpp"

namespace weft {

/// A lane for the components of a pipeline: in shared memory where a stage has a process of its
/// own.
Result<std::unique_ptr<host::Lane>> lane_of(const PipelineConfig& config, host::Lane::Log log);

/// An opened pipeline, frame by frame: what a run does with a frame before it is filed.
class FrameLoop {
 public:
  /// Opens source and template and makes the stages; pipeline and lane outlive the loop.
  static Result<std::unique_ptr<FrameLoop>> open(const CheckedPipeline& pipeline, host::Lane& lane);

  /// Makes and opens the sinks, in their order; the first error ends it.
  Result<void> open_sinks();

  PipelineInput& input() { return input_; }
  Executor& executor() { return *executor_; }

  /// What the frames said of the set-up until now.
  std::vector<RunWarning> warnings() const;

  /// The stages of a frame; the report of the source comes first.
  FrameResult process(const PipelineInput::Frame& read);

  /// Shows the frame to the monitor of the set-up, then to the sinks, whose reports are added.
  void finish(FrameResult& result);

  /// The next frame is the first of a sequence, see Executor::restart().
  void restart();

  /// Finishes all sinks, whatever one of them says; the first error counts.
  Result<void> close_sinks();

 private:
  struct Sink {
    const StageConfig* config;
    const Node* node;
    host::Instance* instance;
  };

  FrameLoop(const CheckedPipeline& pipeline, host::Lane& lane, PipelineInput input)
      : pipeline_(pipeline), lane_(lane), input_(std::move(input)) {}
  void watch_set_up();
  StageReport write(const Sink& sink, const FrameResult& result);

  const CheckedPipeline& pipeline_;
  host::Lane& lane_;
  PipelineInput input_;
  std::unique_ptr<Executor> executor_;
  std::optional<SetupMonitor> monitor_;
  std::vector<Sink> sinks_;
};

}  // namespace weft
