// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/frame_loop.hpp"

#include <algorithm>
#include <thread>
#include <weft/core/index.hpp>
#include <weft/data/run_report.hpp>

#include "host/roles/role_rules.hpp"
#include "pipeline/execution/stage_maker.hpp"
#include "pipeline/runs/frame_json.hpp"
#include "pipeline/steering/settings_json.hpp"

namespace weft {

using host::Outcome;

namespace {

int threads_of(const PipelineConfig& config) {
  const auto cores = static_cast<int>(std::thread::hardware_concurrency());
  return config.threads > 0 ? config.threads : std::max(cores, 1);
}

}  // namespace

int frames_at_once_of(const PipelineConfig& config) {
  if (config.frames_at_once > 0) return config.frames_at_once;
  const bool is_steered =
      std::any_of(config.sinks.begin(), config.sinks.end(),
                  [](const StageConfig& sink) { return sink.component.component().steers_runs(); });
  return threads_of(config) > 1 && !config.latest_only && !is_steered ? 2 : 1;
}

int workers_of(const PipelineConfig& config) {
  return std::min(frames_at_once_of(config), threads_of(config));
}

Result<std::unique_ptr<host::ExecutionContext>> context_of(const PipelineConfig& config,
                                                           host::ExecutionContext::Log log) {
  std::shared_ptr<host::SharedArena> arena;
  if (has_isolated(config)) {
    auto made = host::SharedArena::create();
    if (!made) return made.error();
    arena = *std::move(made);
  }
  auto context =
      std::make_unique<host::ExecutionContext>(config.seed, std::move(log), std::move(arena));
  context->divide_threads(threads_of(config), workers_of(config));
  // The thread that reads ahead is another one.
  if (config.latest_only) context->times().count(host::ProcessorTime::of_thread);
  return context;
}

FrameLine line_of(const std::vector<FrameStep>& steps, std::size_t frames_at_once) {
  std::vector<StepRule> rules;
  std::size_t settled = 0;
  for (const FrameStep& step : steps) {
    if (step.kind == FrameStep::Kind::end) settled = rules.size();
    rules.push_back(step.rule);
  }
  return FrameLine(std::move(rules), settled, frames_at_once);
}

Result<std::unique_ptr<FrameLoop>> FrameLoop::open(const CheckedPipeline& pipeline,
                                                   host::ExecutionContext& context,
                                                   host::RecordPtr camera) {
  auto input = PipelineInput::open(pipeline.config, context, std::move(camera));
  if (!input) return input.error();
  std::unique_ptr<FrameLoop> loop(new FrameLoop(pipeline, context, *std::move(input)));
  auto executor = Executor::create(pipeline.config, pipeline.graph, context, loop->input_.templ(),
                                   loop->input_.camera());
  if (!executor) return executor.error();
  loop->executor_ = *std::move(executor);
  loop->watch_set_up();
  return loop;
}

/// A mesh that is no surface has no lengths to judge by: such a run is not watched.
void FrameLoop::watch_set_up() {
  monitor_.reset();
  if (auto made =
          SetupMonitor::create(*input_.templ(), input_.camera(), pipeline_.config.is_sequence)) {
    monitor_.emplace(*std::move(made));
  }
}

Result<void> FrameLoop::open_sinks() {
  const std::vector<StageConfig>& sinks = pipeline_.config.sinks;
  for (std::size_t i = 0; i < sinks.size(); ++i) {
    const auto instance = instantiate(context_, sinks[i], sinks[i].component);
    if (!instance) return instance.error();
    auto ready = context_.prepare(**instance, *input_.templ(), *input_.camera());
    if (!ready) return ready;
    const Outcome opened = context_.call(**instance, kOpenSink, {}, host::kOfflineFrame);
    if (!opened.usable()) return opened.error;
    host::ExecutionContext::let_finish(**instance);
    sinks_.push_back({sinks[i].name, &pipeline_.graph.sinks[i], *instance});
  }
  report_ = value_for_sinks("frame_report");
  settings_ = value_for_sinks("run_settings");
  if (settings_) set_settings(settings_json(pipeline_.config));
  return {};
}

/// Nothing where no sink reads it.
std::optional<std::size_t> FrameLoop::value_for_sinks(std::string_view slot) const {
  for (const Node& sink : pipeline_.graph.sinks) {
    for (const InputLink& link : sink.inputs) {
      if (link.slot == slot) return to_index(link.value);
    }
  }
  return std::nullopt;
}

std::vector<const host::Instance*> FrameLoop::steering_sinks() const {
  std::vector<const host::Instance*> steering;
  for (const Sink& sink : sinks_) {
    if (host::ExecutionContext::steers(*sink.instance)) steering.push_back(sink.instance);
  }
  return steering;
}

void FrameLoop::set_settings(std::string json) {
  const auto record = host::Record::copy_of(RunSettings{std::move(json)});
  static_cast<void>(context_.admit(*record, "run_settings"));  // a text is legal with any content
  now_set_ = record;
}

std::vector<RunWarning> FrameLoop::warnings() const {
  return monitor_ ? monitor_->warnings() : std::vector<RunWarning>{};
}

std::vector<std::pair<std::string, double>> FrameLoop::camera() const {
  return monitor_ ? monitor_->camera() : std::vector<std::pair<std::string, double>>{};
}

FrameOnItsWay FrameLoop::begin(PipelineInput::Frame read) {
  FrameResult result = executor_->begin(read.input);
  if (settings_) result.values[*settings_] = now_set_;
  return {std::move(read), std::move(result)};
}

std::vector<FrameStep> FrameLoop::steps() const {
  using Kind = FrameStep::Kind;
  const std::vector<StepRule> of_stages = executor_->rules();
  std::vector<FrameStep> steps{{Kind::read}};
  for (std::size_t i = 0; i < of_stages.size(); ++i) {
    steps.push_back({Kind::stage, i, of_stages[i]});
  }
  steps.push_back({Kind::end});
  const std::size_t behind_end = steps.size();
  for (std::size_t i = 0; i < sinks_.size(); ++i) steps.push_back({Kind::sink, i});
  steps.push_back({Kind::file});
  // Output after the end of a frame is complete or absent.
  steps[behind_end].rule.busy_for = sinks_.size();
  return steps;
}

void FrameLoop::take(const FrameStep& step, FrameOnItsWay& frame) {
  using Kind = FrameStep::Kind;
  FrameResult& result = frame.result;
  if (step.kind == Kind::stage) executor_->run_stage(step.index, result);
  if (step.kind == Kind::end) end(frame);
  if (step.kind == Kind::sink) result.stages.push_back(write(sinks_[step.index], result));
}

void FrameLoop::end(FrameOnItsWay& frame) {
  FrameResult& result = frame.result;
  executor_->end(result);
  result.stages.insert(result.stages.begin(), frame.read.report);
  if (monitor_) monitor_->add(pipeline_.graph, result);
  if (report_) result.values[*report_] = host::Record::copy_of(FrameReport{frame_json(result, {})});
}

FrameResult FrameLoop::process(const PipelineInput::Frame& read) {
  FrameOnItsWay frame = begin(read);
  for (std::size_t i = 0; i < pipeline_.graph.stages.size(); ++i) {
    executor_->run_stage(i, frame.result);
  }
  end(frame);
  return std::move(frame.result);
}

void FrameLoop::finish(FrameResult& result) {
  for (const Sink& sink : sinks_) result.stages.push_back(write(sink, result));
  for (const host::Timing& timing : context_.times().take(result.index)) {
    result.timings.push_back(timing);
  }
}

void FrameLoop::restart() {
  executor_->restart();
  watch_set_up();
}

StageReport FrameLoop::write(const Sink& sink, const FrameResult& result) {
  CallInputs inputs;
  const host::SharedText cause = gather(*sink.node, result, inputs);
  if (!cause.empty()) return {sink.name, StageStatus::skipped, cause, {}, {}, false};
  const host::Stopwatch watch = context_.times().stopwatch();
  const Outcome outcome = context_.call(*sink.instance, kWriteFrame, inputs, result.index);
  return report_of(sink.name, outcome, watch.spent(), context_.memory());
}

Result<void> FrameLoop::close_sinks() {
  Result<void> status;
  for (const Sink& sink : sinks_) {
    const Outcome closed = context_.call(*sink.instance, kFinishSink, {}, host::kOfflineFrame);
    const bool is_cut_short =
        closed.error.code == Errc::cancelled && context_.cancellation().is_requested();
    if (!closed.usable() && !is_cut_short && status) {
      status = Error{Errc::io, closed.error.message, closed.error.where};
    }
  }
  return status;
}

}  // namespace weft
