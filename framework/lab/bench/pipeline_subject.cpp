// SPDX-License-Identifier: Apache-2.0
#include "lab/bench/pipeline_subject.hpp"

#include <algorithm>
#include <set>
#include <weft/core/index.hpp>

namespace weft::bench {
namespace {

/// Adds the arrays that are in host memory and not yet known, and remembers them.
std::uint64_t add_arrays(const host::Record& record, std::set<const void*>& known) {
  std::uint64_t bytes = 0;
  const weft_record view = record.view("");
  for (std::uint64_t i = 0; i < view.count; ++i) {
    const weft_array& array = view.arrays[i];
    if (array.data == nullptr || !known.insert(array.data).second) continue;
    bytes += to_index(
        std::max<std::int64_t>(0, host::array_bytes(array.dtype, array.ndim, array.shape)));
  }
  return bytes;
}

bool is_of_set_up(const ValueInfo& value) {
  return value.slot == "template" || value.slot == "camera";
}

}  // namespace

Moved moved_by(const Node& node, const Graph& graph, const FrameResult& frame) {
  Moved moved;
  std::set<const void*> known;
  for (const InputLink& link : node.inputs) {
    const host::RecordPtr& record = frame.values[to_index(link.value)];
    if (record == nullptr || is_of_set_up(graph.values[to_index(link.value)])) continue;
    moved.in += add_arrays(*record, known);
  }
  for (const int output : node.outputs) {
    const host::RecordPtr& record = frame.values[to_index(output)];
    if (record == nullptr || graph.values[to_index(output)].slot == "template_keypoints") continue;
    moved.out += add_arrays(*record, known);
  }
  return moved;
}

CheckedPipeline without_sinks(CheckedPipeline pipeline) {
  pipeline.config.sinks.clear();
  pipeline.graph.sinks.clear();
  return pipeline;
}

Error error_of(const FrameResult& result, bool cancelled) {
  if (cancelled) return {Errc::cancelled, "cancelled", {}};
  const std::string frame = "frame " + std::to_string(result.index) + ": ";
  for (const StageReport& report : result.stages) {
    if (report.status != StageStatus::error) continue;
    return {report.code, frame + report.stage + ": " + report.reason, {}};
  }
  return {Errc::plugin_failure, frame + "failed", {}};
}

Result<Settings> settled(const Settings& settings,
                         const std::vector<std::unique_ptr<PipelineSubject>>& subjects,
                         bool exact) {
  constexpr std::int64_t kLeast = 2;
  Settings result = settings;
  for (const auto& subject : subjects) {
    const auto frames = static_cast<std::int64_t>(subject->reading().size());
    result.frames = std::min(result.frames, frames - settings.warmup);
    const std::int64_t wanted = exact ? settings.frames : kLeast;
    if (result.frames >= wanted) continue;
    return Error{Errc::invalid_value,
                 "its source has " + std::to_string(frames) + " frames; " +
                     std::to_string(settings.warmup) + " to warm up and " +
                     (exact ? "" : "at least ") + std::to_string(wanted) +
                     " to measure are needed: see --frames and --warmup",
                 subject->config().file};
  }
  return result;
}

Result<std::unique_ptr<PipelineSubject>> PipelineSubject::open(CheckedPipeline pipeline,
                                                               std::int64_t frames,
                                                               const std::atomic<bool>& cancel) {
  std::unique_ptr<PipelineSubject> subject(new PipelineSubject(std::move(pipeline), cancel));
  auto opened = subject->open_all(frames);
  if (!opened) return opened.error();
  return subject;
}

PipelineSubject::~PipelineSubject() {
  if (loop_ == nullptr) return;
  context_->cancellation().watch(nullptr);
  static_cast<void>(loop_->close_sinks());  // the files of the sinks are discarded
}

Result<void> PipelineSubject::open_all(std::int64_t frames) {
  auto context = context_of(pipeline_.config, {});
  if (!context) return context.error();
  context_ = *std::move(context);
  // Frames are measured one after another: the further threads of a stage count too.
  context_->times().count(host::ProcessorTime::of_process);
  context_->cancellation().watch([this] { return cancel_.load(); });
  auto loop = FrameLoop::open(pipeline_, *context_);
  if (!loop) return loop.error();
  loop_ = *std::move(loop);
  if (auto opened = loop_->open_sinks(); !opened) return opened;
  const std::int64_t known = loop_->input().frames();
  const std::int64_t count = known < 0 ? frames : std::min(known, frames);
  for (std::int64_t index = 0; index < count; ++index) {
    if (cancel_.load()) return Error{Errc::cancelled, "cancelled", {}};
    auto read = loop_->input().read(to_index(index));
    if (!read) break;
    reading_.push_back(read->report);
    frames_.push_back(*std::move(read));
  }
  for (const auto* list : {&pipeline_.config.stages, &pipeline_.config.sinks}) {
    for (const StageConfig& stage : *list) parts_.push_back(stage.name);
  }
  moved_.resize(parts_.size());
  return {};
}

std::vector<std::string> PipelineSubject::components() const {
  std::vector<std::string> ids;
  for (const auto* list : {&pipeline_.config.stages, &pipeline_.config.sinks}) {
    for (const StageConfig& stage : *list) ids.push_back(stage.component.component().id);
  }
  return ids;
}

Result<FrameSpent> PipelineSubject::run(std::int64_t frame) {
  const PipelineInput::Frame& read = frames_[to_index(frame)];
  const host::Stopwatch watch;
  FrameResult result = loop_->process(read);
  const bool failed = result.failed();
  if (!failed) loop_->finish(result);
  const host::Spent here = watch.spent();
  if (result.failed()) return blamed(result);
  note(result);
  return spent_in(result, here);
}

Error PipelineSubject::blamed(const FrameResult& result) const {
  Error error = error_of(result, cancel_.load());
  error.where = pipeline_.config.file;
  return error;
}

Result<Overlapped> PipelineSubject::run_overlapping(std::int64_t frames) {
  using Kind = FrameStep::Kind;
  using enum FrameLine::Answer;
  restart();
  Overlapped run;
  run.frames.resize(to_index(frames));
  std::vector<std::optional<FrameOnItsWay>> on_their_way(
      to_index(frames_at_once_of(pipeline_.config)));
  std::optional<Error> error;
  double workers_ms = 0.0;
  const host::Stopwatch watch;
  const auto since_begin_ms = [&] {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() -
                                                     watch.start())
        .count();
  };
  const std::vector<FrameStep> steps = loop_->steps();
  const auto take = [&](std::size_t step, std::uint64_t place) {
    if (place >= run.frames.size()) return not_there;
    std::optional<FrameOnItsWay>& frame = on_their_way[place % on_their_way.size()];
    if (steps[step].kind == Kind::read) {
      run.frames[place].entered_ms = since_begin_ms();
      frame.emplace(loop_->begin(frames_[place]));
      return passed;
    }
    if (steps[step].kind != Kind::file) loop_->take(steps[step], *frame);
    // Frames come to these steps in their order: the first error is that of the first frame.
    const bool may_fail = steps[step].kind == Kind::end || steps[step].kind == Kind::file;
    if (may_fail && frame->result.failed()) {
      if (!error) error = blamed(frame->result);
      return not_there;
    }
    if (steps[step].kind != Kind::file) return passed;
    context_->times().take(frame->result.index);
    for (const StageReport& report : frame->result.stages) {
      workers_ms += report.worker_processor_ms;
    }
    frame.reset();
    run.frames[place].left_ms = since_begin_ms();
    return passed;
  };
  line_of(steps, on_their_way.size()).run(workers_of(pipeline_.config), take);
  if (error) return *error;
  run.whole = watch.spent();
  run.whole.processor_ms += workers_ms;
  return run;
}

void PipelineSubject::note(const FrameResult& result) {
  ++states_[to_string(result.state)];
  const Graph& graph = pipeline_.graph;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (result.stages[i + 1].status == StageStatus::skipped) continue;
    const std::size_t stages = graph.stages.size();
    const Node& node = i < stages ? graph.stages[i] : graph.sinks[i - stages];
    const Moved moved = moved_by(node, graph, result);
    moved_[i].bytes.in += moved.in;
    moved_[i].bytes.out += moved.out;
    ++moved_[i].runs;
  }
}

}  // namespace weft::bench
