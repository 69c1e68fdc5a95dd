// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/frame_loop.hpp"

#include <algorithm>

#include "roles/role_rules.hpp"

namespace weft {

using host::Outcome;

Result<std::unique_ptr<host::Lane>> lane_of(const PipelineConfig& config, host::Lane::Log log) {
  const bool isolated = std::any_of(config.stages.begin(), config.stages.end(),
                                    [](const StageConfig& stage) { return stage.isolation; });
  std::shared_ptr<host::SharedArena> arena;
  if (isolated) {
    auto made = host::SharedArena::create();
    if (!made) return made.error();
    arena = *std::move(made);
  }
  return std::make_unique<host::Lane>(config.seed, std::move(log), std::move(arena));
}

Result<std::unique_ptr<FrameLoop>> FrameLoop::open(const CheckedPipeline& pipeline,
                                                   host::Lane& lane) {
  auto input = PipelineInput::open(pipeline.config, lane);
  if (!input) return input.error();
  std::unique_ptr<FrameLoop> loop(new FrameLoop(pipeline, lane, *std::move(input)));
  auto executor = Executor::create(pipeline.config, pipeline.graph, lane, loop->input_.templ(),
                                   loop->input_.camera());
  if (!executor) return executor.error();
  loop->executor_ = *std::move(executor);
  loop->watch_set_up();
  return loop;
}

/// A mesh that is no surface has no lengths to judge by: such a run is not watched.
void FrameLoop::watch_set_up() {
  monitor_.reset();
  if (auto made = SetupMonitor::create(*input_.templ(), input_.camera())) {
    monitor_.emplace(*std::move(made));
  }
}

Result<void> FrameLoop::open_sinks() {
  const std::vector<StageConfig>& sinks = pipeline_.config.sinks;
  for (std::size_t i = 0; i < sinks.size(); ++i) {
    const auto instance = lane_.instantiate(sinks[i].component, sinks[i].name);
    if (!instance) return instance.error();
    auto ready = lane_.prepare(**instance, *input_.templ(), *input_.camera());
    if (!ready) return ready;
    const Outcome opened = lane_.call(**instance, kOpenSink, {}, host::kOfflineFrame);
    if (!opened.usable()) return opened.error;
    sinks_.push_back({&sinks[i], &pipeline_.graph.sinks[i], *instance});
  }
  return {};
}

std::vector<RunWarning> FrameLoop::warnings() const {
  return monitor_ ? monitor_->warnings() : std::vector<RunWarning>{};
}

FrameResult FrameLoop::process(const PipelineInput::Frame& read) {
  FrameResult result = executor_->process(read.input);
  result.stages.insert(result.stages.begin(), read.report);
  return result;
}

void FrameLoop::finish(FrameResult& result) {
  if (monitor_) monitor_->add(pipeline_.graph, result);
  for (const Sink& sink : sinks_) result.stages.push_back(write(sink, result));
  for (const host::Timing& timing : lane_.take_timings()) result.timings.push_back(timing);
}

void FrameLoop::restart() {
  executor_->restart();
  watch_set_up();
}

StageReport FrameLoop::write(const Sink& sink, const FrameResult& result) {
  std::vector<weft_record> inputs;
  const std::string cause = gather(*sink.node, result, inputs);
  if (!cause.empty()) return {sink.config->name, StageStatus::skipped, cause, {}, {}, false};
  const host::Stopwatch watch;
  const Outcome outcome = lane_.call(*sink.instance, kWriteFrame, inputs, result.index);
  return report_of(sink.config->name, outcome, watch.spent());
}

Result<void> FrameLoop::close_sinks() {
  Result<void> status;
  for (const Sink& sink : sinks_) {
    const Outcome closed = lane_.call(*sink.instance, kFinishSink, {}, host::kOfflineFrame);
    if (!closed.usable() && status) {
      status = Error{Errc::io, closed.error.message, closed.error.where};
    }
  }
  return status;
}

}  // namespace weft
