// SPDX-License-Identifier: Apache-2.0
#include "pipeline/execution/executor.hpp"

#include <algorithm>
#include <weft/core/index.hpp>

#include "pipeline/execution/checks.hpp"
#include "pipeline/execution/compose.hpp"
#include "pipeline/execution/stage_maker.hpp"
#include "pipeline/execution/weak_reason.hpp"

namespace weft {

using host::Outcome;
using host::Record;
using host::RecordPtr;

namespace {

/// Why a value that no stage makes is absent, where its source could read the frame.
std::string why_absent(const ValueInfo& value) {
  if (value.lag == 0) return "sources: no " + value.slot;
  return value.slot + ": none " + std::to_string(value.lag) + " frames ago";
}

/// Why a stage is not called where its rule does not hold: all that it waits for are ok.
std::string why_not_called(const StageConfig& stage, const Node& node,
                           const std::vector<StageConfig>& stages) {
  std::string reasons;
  for (const int other : node.not_ok) {
    reasons += (reasons.empty() ? "'" : ", '") + stages[to_index(other)].name + "' is ok";
  }
  if (stage.when->every == 0) return "not called: " + reasons;
  return "not called: " + (reasons.empty() ? "" : reasons + ", and ") + "it is called every " +
         std::to_string(stage.when->every) + " frames";
}

}  // namespace

Executor::Executor(const PipelineConfig& config, const Graph& graph,
                   host::ExecutionContext& context, RecordPtr templ, RecordPtr camera,
                   Sharing sharing)
    : config_(config),
      graph_(graph),
      context_(context),
      template_(std::move(templ)),
      camera_(std::move(camera)),
      sharing_(std::move(sharing)),
      history_(graph) {
  for (const ValueInfo& value : graph.values) absent_.emplace_back(why_absent(value));
}

Result<std::unique_ptr<Executor>> Executor::create(const PipelineConfig& config, const Graph& graph,
                                                   host::ExecutionContext& context, RecordPtr templ,
                                                   RecordPtr camera, Sharing sharing) {
  std::unique_ptr<Executor> executor(new Executor(config, graph, context, std::move(templ),
                                                  std::move(camera), std::move(sharing)));
  const auto sheet = host::view_as<Template>(*executor->template_);
  if (!sheet) return sheet.error();
  executor->vertices_ = {sheet->flat_px, 1};
  for (std::size_t i = 0; i < config.stages.size(); ++i) {
    const StageConfig& stage = config.stages[i];
    const auto& keys = executor->sharing_.keys;
    const std::string key = i < keys.size() ? keys[i] : "";
    auto made = executor->made_stage(stage, key);
    if (!made) return made.error();
    executor->stages_.push_back(executor->stage_of(i, *std::move(made)));
    executor->stages_.back().key = key;
  }
  return executor;
}

Executor::Stage Executor::stage_of(std::size_t index, MadeStage made) const {
  const StageConfig& config = config_.stages[index];
  const Node& node = graph_.stages[index];
  Stage stage{std::shared_ptr<const StageConfig>(std::shared_ptr<void>(), &config),
              &node,
              rules_of(config.role),
              std::move(made),
              {},
              MatchPlacer(template_, context_.memory()),
              config.name,
              {},
              {}};
  if (config.when) {
    stage.not_called = why_not_called(config, node, config_.stages);
    stage.not_called_cause = config.name + ": " + stage.not_called;
  }
  return stage;
}

Result<MadeStage> Executor::made_stage(const StageConfig& stage, const std::string& key) {
  const StageMaker maker{context_, template_, camera_};
  if (sharing_.memo == nullptr) return maker.make(stage);
  if (sharing_.memo->made(key) == nullptr) sharing_.memo->keep(key, maker.make(stage));
  return *sharing_.memo->made(key);
}

void Executor::place_given(const FrameInput& input, FrameResult& result) const {
  for (std::size_t i = 0; i < graph_.values.size(); ++i) {
    const ValueInfo& value = graph_.values[i];
    if (value.stage >= 0) continue;
    if (value.slot == "template") {
      result.values[i] = template_;
    } else if (value.slot == "camera") {
      result.values[i] = camera_;
    } else if (value.lag == 0) {
      result.values[i] = input.find(value.slot);
      result.causes[i] =
          input.failure.empty() ? absent_[i] : host::SharedText("sources: " + input.failure);
    }
  }
}

/// The past of a frame is final only when the frames that it looks back to are settled.
void Executor::place_past(std::size_t value, FrameResult& result) const {
  const ValueInfo& info = graph_.values[value];
  if (info.lag == 0) return;
  result.values[value] = history_.find(info.slot, info.lag, result.place);
  result.causes[value] = absent_[value];
}

FrameResult Executor::process(const FrameInput& input) {
  FrameResult result = begin(input);
  for (std::size_t i = 0; i < stages_.size(); ++i) run_stage(i, result);
  end(result);
  return result;
}

FrameResult Executor::begin(const FrameInput& input) {
  FrameResult result(context_.memory());
  result.stages.reserve(1 + stages_.size() + graph_.sinks.size());
  result.index = input.index;
  result.place = begun_++;
  result.dropped_before = input.dropped_before;
  if (config_.budget_ms > 0) {
    result.deadline = host::SteadyTime::clock::now() + std::chrono::milliseconds(config_.budget_ms);
  }
  result.values.resize(graph_.values.size());
  result.causes.resize(graph_.values.size());
  place_given(input, result);
  if (const int image = graph_.latest("image"); image >= 0) {
    if (const RecordPtr& record = result.values[to_index(image)]) {
      const weft_array* stem = find_array(record->view(""), "stem");
      result.stem.assign(static_cast<const char*>(stem->data), to_index(stem->shape[0]));
    }
  }
  return result;
}

void Executor::run_stage(std::size_t stage, FrameResult& result) {
  change_until(result.place, stages_[stage]);
  for (const InputLink& link : stages_[stage].node->inputs) {
    place_past(to_index(link.value), result);
  }
  result.stages.push_back(answer(stages_[stage], result));
}

void Executor::change(std::size_t stage, std::shared_ptr<const StageConfig> config,
                      MadeStage made) {
  const std::lock_guard lock(changes_mutex_);
  stages_[stage].changes.push_back({begun_, std::move(config), std::move(made)});
}

/// Frames before that one have passed the stage and all that call its component again, see rules().
void Executor::change_until(std::uint64_t place, Stage& stage) {
  const std::lock_guard lock(changes_mutex_);
  while (!stage.changes.empty() && stage.changes.front().place <= place) {
    Change change = std::move(stage.changes.front());
    stage.changes.pop_front();
    context_.replace(*stage.made.instance, *change.made.instance);
    stage.made = std::move(change.made);
    stage.config = std::move(change.config);
  }
}

void Executor::end(FrameResult& result) {
  for (std::size_t value = 0; value < graph_.values.size(); ++value) place_past(value, result);
  settle_shape(result);
  history_.remember(result.values);
  result.timings = context_.times().take(result.index);
  context_.memory()->frame_done(result.index);
}

std::vector<StepRule> Executor::rules() const {
  std::vector<StepRule> rules(stages_.size());
  for (std::size_t i = 0; i < stages_.size(); ++i) {
    for (const InputLink& link : stages_[i].node->inputs) {
      const ValueInfo& value = graph_.values[to_index(link.value)];
      // The component that made a warp may fit the one of the frame before meanwhile.
      const int lag = value.slot == "previous.warp" ? 1 : value.lag;
      int& back = rules[i].frames_back;
      if (lag > 0) back = back == 0 ? lag : std::min(back, lag);
    }
    if (stages_[i].rules.samples) rules[i].busy_for = steps_to_last_user_of_warp(i);
  }
  return rules;
}

/// A reader of a warp may have the component that made it evaluate it.
std::size_t Executor::steps_to_last_user_of_warp(std::size_t stage) const {
  const auto reads = [&](const Node& node) {
    return std::any_of(node.inputs.begin(), node.inputs.end(), [&](const InputLink& link) {
      const ValueInfo& value = graph_.values[to_index(link.value)];
      const bool is_own = value.slot == "warp" && value.stage == static_cast<int>(stage);
      return is_own || value.slot == "previous.warp";
    });
  };
  if (std::any_of(graph_.sinks.begin(), graph_.sinks.end(), reads)) {
    return stages_.size() - stage + graph_.sinks.size();
  }
  std::size_t last = stage;
  for (std::size_t i = stage + 1; i < stages_.size(); ++i) {
    if (reads(*stages_[i].node)) last = i;
  }
  return last - stage;
}

void Executor::restart() {
  history_.forget();
  frames_since_measured_ = 0;
}

void Executor::keep_calls_of(const std::string& name) {
  for (Stage& stage : stages_) stage.is_kept = stage.is_kept || stage.config->name == name;
}

void Executor::keep_call(const Stage& stage, const Outcome& outcome, FrameResult& result) const {
  StageCall call{stage.config->name, result.index, {}, outcome};
  for (const InputLink& link : stage.node->inputs) {
    const RecordPtr& record = result.values[to_index(link.value)];
    if (record == nullptr) continue;
    GivenRecord& given = call.inputs.emplace_back(GivenRecord{link.slot, record, {}});
    const std::uint64_t producer = record->view("").producer;
    const std::lock_guard lock(changes_mutex_);  // others may change meanwhile
    for (const Stage& other : stages_) {
      if (host::handle_of(*other.made.instance) == producer) given.producer = other.config->name;
    }
  }
  result.calls.push_back(std::move(call));
}

StageAnswer Executor::answer_of(const Stage& stage, StageReport report, const FrameResult& result) {
  StageAnswer answer{std::move(report), {}, {}};
  for (const int output : stage.node->outputs) {
    answer.outputs.push_back(result.values[to_index(output)]);
    answer.causes.push_back(result.causes[to_index(output)]);
  }
  return answer;
}

StageReport Executor::take(const StageAnswer& answer, const Stage& stage, FrameResult& result) {
  for (std::size_t i = 0; i < answer.outputs.size(); ++i) {
    const auto output = to_index(stage.node->outputs[i]);
    result.values[output] = answer.outputs[i];
    result.causes[output] = answer.causes[i];
  }
  StageReport report = answer.report;
  report.shared = true;
  return report;
}

/// Applies the rule of `when`.
bool Executor::is_called(const Stage& stage, const FrameResult& result) {
  if (!stage.config->when) return true;
  const auto every = static_cast<std::uint64_t>(stage.config->when->every);
  // A multiple that was dropped is made up for by the next frame.
  if (every > 0 && result.index % every <= result.dropped_before) return true;
  return std::any_of(stage.node->not_ok.begin(), stage.node->not_ok.end(), [&](int other) {
    return result.stages[to_index(other)].status != StageStatus::ok;
  });
}

StageReport Executor::answer(Stage& stage, FrameResult& result) {
  if (sharing_.memo == nullptr) return execute(stage, result);
  if (const StageAnswer* answer = sharing_.memo->answer(stage.key)) {
    return take(*answer, stage, result);
  }
  StageReport report = execute(stage, result);
  sharing_.memo->keep(stage.key, answer_of(stage, report, result));
  return report;
}

StageReport Executor::execute(Stage& stage, FrameResult& result) {
  CallInputs inputs;
  const bool is_wanted = is_called(stage, result);
  const host::SharedText why_skipped =
      is_wanted ? gather(*stage.node, result, inputs) : stage.not_called;
  if (!why_skipped.empty()) {
    for (const int output : stage.node->outputs) {
      result.causes[to_index(output)] = is_wanted ? why_skipped : stage.not_called_cause;
    }
    return {stage.name, StageStatus::skipped, why_skipped, {}, {}, false};
  }
  const host::Stopwatch watch = context_.times().stopwatch();
  Outcome outcome = context_.cancellation().is_requested()
                        ? Outcome{WEFT_CANCELLED, {Errc::cancelled, "was not begun", {}}, {}}
                        : context_.call(*stage.made.instance, kRunStage, inputs, result.index, 0,
                                        result.deadline);
  if (result.late_in.empty() && result.deadline != host::kNoDeadline &&
      host::SteadyTime::clock::now() > result.deadline) {
    result.late_in = stage.name;
  }
  if (stage.is_kept) keep_call(stage, outcome, result);
  if (outcome.usable()) {
    if (auto stored = store(stage, outcome, result); !stored) {
      const Error& error = stored.error();
      const bool none = error.code == Errc::no_result;
      const std::string id = stage.config->component.component().id;
      outcome = {none ? WEFT_NO_RESULT : WEFT_ERROR, {error.code, error.message, id}, {}};
    }
  }
  StageReport report = report_of(stage.name, outcome, watch.spent(), context_.memory());
  host::SharedText cause;
  for (const int output : stage.node->outputs) {
    const RecordPtr& record = result.values[to_index(output)];
    if (record == nullptr) {
      if (cause.empty()) cause = stage.name + ": " + report.reason;
      result.causes[to_index(output)] = cause;
    } else if (record != stage.made.template_keypoints) {
      add_numbers(*record, report);
    }
  }
  if (stage.rules.marks && outcome.usable()) add_numbers(*outcome.find("inlier_mask"), report);
  return report;
}

Result<host::PooledVector<RecordPtr>> Executor::outputs_of(const Stage& stage,
                                                           const Outcome& outcome,
                                                           const FrameResult& result) {
  host::PooledVector<RecordPtr> made(context_.memory());
  made.reserve(stage.node->outputs.size());
  if (stage.rules.marks) {
    const auto before = to_index(stage.node->inputs.front().value);
    auto composed =
        with_mask(*result.values[before], *outcome.find("inlier_mask"), context_.memory());
    if (!composed) return composed.error();
    made.push_back(*std::move(composed));
  } else if (stage.rules.samples) {
    RecordPtr warp = outcome.find("warp");
    const Outcome samples = context_.evaluate(*warp, vertices_, result.index);
    if (!samples.usable()) return samples.error;
    made.push_back(std::move(warp));
    made.push_back(samples.find("warp_samples"));
  } else if (stage.rules.sees_texture) {
    made.push_back(outcome.find("keypoints"));
    made.push_back(stage.made.template_keypoints);
  } else {
    for (const int output : stage.node->outputs) {
      made.push_back(outcome.find(graph_.values[to_index(output)].slot));
    }
  }
  return made;
}

Result<void> Executor::store(Stage& stage, const Outcome& outcome, FrameResult& result) {
  auto made = outputs_of(stage, outcome, result);
  if (!made) return made.error();
  for (RecordPtr& record : *made) {
    if (record == nullptr) continue;
    auto placed = stage.placer.place(record);
    if (!placed) return placed.error();
    record = *std::move(placed);
    if (auto fits = check_fits(*record, *template_, *camera_); !fits) return fits;
  }
  for (std::size_t i = 0; i < made->size(); ++i) {
    result.values[to_index(stage.node->outputs[i])] = (*made)[i];
  }
  return {};
}

void Executor::settle_shape(FrameResult& result) {
  int settled = -1;
  for (std::size_t i = 0; i < graph_.values.size(); ++i) {
    if (graph_.values[i].slot == "shape" && result.values[i] != nullptr) {
      result.shape = result.values[i];
      settled = static_cast<int>(i);
    }
  }
  if (result.shape != nullptr) {
    frames_since_measured_ = 0;
  } else if (const RecordPtr before = history_.find("previous.shape", 1, result.place)) {
    ++frames_since_measured_;
    result.shape =
        aged_shape(*before, frames_since_measured_, config_.lost_after, context_.memory());
  }
  if (result.shape == nullptr) return;
  // Sinks see the frame's shape where the last solver's would be; no stage runs after this.
  result.values[to_index(graph_.latest("shape"))] = result.shape;
  const auto shape = host::arrays_of<Shape>(*result.shape);
  result.state = shape->shape_state();
  result.age_frames = shape->age_frames;
  if (result.state == ShapeState::weak) result.reason = weak_reason(graph_, result, settled);
}

}  // namespace weft
