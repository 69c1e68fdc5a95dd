// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <weft/core/index.hpp>

#include "host/calling/execution_context_parts.hpp"
#include "host/calling/hashing.hpp"
#include "host/calling/judge_shape.hpp"
#include "host/calling/protected_inputs.hpp"
#include "host/guarding/library_call.hpp"
#include "host/guarding/process_state.hpp"
#include "host/records/plugin_error.hpp"
#include "host/records/value_check.hpp"

namespace weft::host {

namespace {

constexpr int kDeepestNesting = 16;

Error not_begun(const std::string& id) {
  return {Errc::cancelled, "cancelled before it began", id};
}

bool must_produce(const Instance& instance, const RoleSlot& output) {
  if (output.required || !instance.rules.gives_all) return output.required;
  const std::vector<std::string>& produced = instance.produces;
  return std::find(produced.begin(), produced.end(), output.name) != produced.end();
}

}  // namespace

RecordPtr Outcome::find(std::string_view slot) const {
  for (const auto& [name, record] : outputs) {
    if (name == slot) return record;
  }
  return nullptr;
}

ExecutionContext::ExecutionContext(std::uint64_t run_seed, Log log,
                                   std::shared_ptr<SharedArena> arena, std::uint64_t revision_mark)
    : run_seed_(run_seed),
      log_(std::move(log)),
      revision_mark_(revision_mark),
      arena_(std::move(arena)) {}

Result<Instance*> ExecutionContext::instantiate(const ComponentSpec& spec, const std::string& stage,
                                                const std::string& path) {
  if (cancellation_.is_requested()) return not_begun(spec.component().id);
  std::optional<Announced> announced;
  if (path.empty()) announced.emplace(*this, stage, spec.component().id, "load", kOfflineFrame);
  const ProcessState before_load;
  const auto table = load(*spec.installed);
  warn_of_changes(before_load, path.empty() ? stage : stage + "/" + path, "while it was loaded");
  if (!table) return table.error();
  auto made = std::make_unique<Instance>(spec, stage, path);
  made->table = *table;
  const auto device_memory = device_memory_of(**table);
  if (!device_memory) return device_memory.error();
  made->device_memory = *device_memory;
  Arguments handles;
  for (const auto& [parameter, child] : spec.nested) {
    const auto nested =
        instantiate(child, stage, path.empty() ? parameter : path + "/" + parameter);
    if (!nested) return nested.error();
    made->nested.push_back(*nested);
    handles.add_component(parameter, (*nested)->handle);
  }
  std::vector<weft_value> values = spec.arguments.values();
  values.insert(values.end(), handles.values().begin(), handles.values().end());
  void* self = nullptr;
  weft_error error = kNoError;
  weft_create with = made_from(values);
  with.host = &host_table();  // a component may keep it and use it in its calls
  const ProcessState before;
  const std::int32_t status = call_library(
      made->id.c_str(), error, [&] { return made->table->create(&with, &self, &error); });
  warn_of_changes(before, made->name, "while it was created");
  if (status != WEFT_OK) return plugin_error(status, error, made->id);
  if (self == nullptr) {
    return Error{Errc::plugin_failure, "created nothing and gave no reason", made->id};
  }
  made->self = self;
  Instance& instance = add(std::move(made));
  // A worker that reads a warp evaluates it itself.
  if (arena_ != nullptr && instance.rules.samples) {
    instance.recreate = CreateMessage{instance.handle, stage, path, Recipe::of(spec)};
  }
  return &instance;
}

Instance& ExecutionContext::add(std::unique_ptr<Instance> instance) {
  instance->run_seed = run_seed_;
  const std::lock_guard lock(instances_mutex_);
  instance->handle = instances_.size() + 1;
  instances_.push_back(std::move(instance));
  return *instances_.back();
}

void ExecutionContext::divide_threads(int threads, int callers) {
  threads_.divide(threads, callers);
  times_.count(callers > 1 ? ProcessorTime::of_thread : ProcessorTime::of_process);
}

weft_call ExecutionContext::make_call(const Instance& instance, Scope& scope, int method) const {
  weft_call call{};
  call.struct_size = sizeof(weft_call);
  call.method = method;
  call.host = &host_table();
  call.context = &scope;
  call.seed = component_seed(instance.run_seed, scope.turn.frame, instance.stage.str(),
                             instance.path, scope.turn.draw);
  call.frame = scope.turn.frame;
  call.threads = scope.turn.threads;
  return call;
}

Result<void> ExecutionContext::prepare(Instance& instance, const Record& templ,
                                       const Record& camera) {
  if (cancellation_.is_requested()) return not_begun(instance.id);
  const Announced announced{*this, instance.name, instance.id, "prepare", kOfflineFrame};
  if (instance.worker != nullptr) {
    return instance.worker->prepare({{"template", templ.alias()}, {"camera", camera.alias()}});
  }
  const weft_record inputs[] = {templ.view("template"), camera.view("camera")};
  return prepare_here(instance, inputs);
}

Result<void> ExecutionContext::prepare_here(Instance& instance,
                                            std::span<const weft_record> inputs) {
  for (Instance* nested : instance.nested) {
    if (auto ready = prepare_here(*nested, inputs); !ready) return ready;
  }
  const bool gets_template =
      instance.rules.part != PipelinePart::source && instance.rules.part != PipelinePart::templ;
  if (!gets_template) return {};
  if (cancellation_.is_requested()) return not_begun(instance.id);
  Scope scope{*this, instance, nullptr, {kOfflineFrame, 0, kOfflineFrame, 0, threads_.equal()}};
  const weft_call call = make_call(instance, scope, 0);
  ProtectedInputs pages;
  if (protects_inputs_) {
    const auto given = pages.copy(inputs);
    if (!given) return given.error();
    inputs = *given;
  }
  scope.inputs = inputs;
  weft_error error = kNoError;
  const ProcessState before;
  const std::int32_t status = call_library(instance.id.c_str(), error, [&] {
    return instance.table->prepare(instance.self, &call, inputs.data(), inputs.size(), &error);
  });
  warn_of_changes(before, instance.name, "while it was prepared");
  if (status == WEFT_OK || status == WEFT_DEGENERATE) return {};
  return plugin_error(status, error, instance.id);
}

Outcome ExecutionContext::call(Instance& instance, int method, std::span<const weft_record> inputs,
                               std::uint64_t frame, std::uint64_t draw, SteadyTime deadline) {
  const std::vector<RoleMethod>& methods = instance.rules.role.methods;
  const auto index = to_index(method);
  static const std::string kNone;
  const Announced announced{*this, instance.name, instance.id,
                            index < methods.size() ? methods[index].name : kNone, frame};
  const ThreadShares::Loan loan(threads_);
  return enter(instance, method, inputs, {frame, draw, frame, 0, loan.threads(), deadline});
}

Outcome ExecutionContext::evaluate(const Record& warp, const Points& points, std::uint64_t frame) {
  const weft_record view = warp.view("warp");
  Instance* producer = find(view.producer);
  if (producer == nullptr) {
    return {WEFT_ERROR, {Errc::not_found, "the warp's producer is gone", {}}, {}};
  }
  const RecordView<Points> points_view("points", points);
  const weft_record inputs[] = {view, points_view.raw()};
  return enter(*producer, kEvaluateWarp, inputs, {frame, 0, frame, 0, threads_.equal()});
}

Outcome ExecutionContext::enter(Instance& instance, int method, std::span<const weft_record> inputs,
                                const Turn& turn) {
  const auto refuse = [&](const std::string& message) {
    return Outcome{WEFT_ERROR, {Errc::plugin_failure, message, instance.id}, {}};
  };
  if (instance.running) return refuse("was called while it was running");
  if (turn.depth > kDeepestNesting) return refuse("is nested too deeply");
  const std::vector<RoleMethod>& methods = instance.rules.role.methods;
  if (method < 0 || method >= static_cast<int>(methods.size())) {
    return refuse("its role has no method " + std::to_string(method));
  }
  if (instance.table != nullptr && (instance.table->methods >> method & 1U) == 0) {
    return refuse("does not offer the method '" + methods[to_index(method)].name + "'");
  }
  Scope scope{*this, instance, &methods[to_index(method)], turn};
  const weft_call call = make_call(instance, scope, method);
  weft_error error = kNoError;
  const Stopwatch watch = times_.stopwatch();
  ReachableInputs reachable;
  auto readable = reachable.reach(inputs, instance.device_memory, call);
  scope.downloaded_bytes = reachable.downloaded_bytes();
  ProtectedInputs pages;
  const bool is_protected = protects_inputs_ && instance.worker == nullptr;
  if (readable && is_protected) readable = pages.copy(*readable);
  std::int32_t status = WEFT_OK;
  if (readable) {
    scope.inputs = *readable;
    instance.running = true;
    status = instance.worker != nullptr
                 ? call_worker(instance, scope, method, *readable, &error)
                 : call_here(instance, call, *readable, turn.run_frame, error);
    instance.running = false;
  } else {
    status = report(readable.error(), &error);
  }
  Spent took = watch.spent();
  took.processor_ms += scope.worker_processor_ms;
  Outcome outcome = finish(instance, scope, inputs, status, error);
  outcome.downloaded_bytes = scope.downloaded_bytes;
  outcome.worker_processor_ms = scope.worker_processor_ms;
  times_.note({instance.name,
               took,
               watch.start(),
               scope.method->name,
               turn.run_frame,
               outcome.status,
               {},
               outcome.downloaded_bytes});
  return outcome;
}

void ExecutionContext::warn_of_changes(const ProcessState& before, const std::string& stage,
                                       const char* when) const {
  const std::string changes = before.restore(when);
  if (!changes.empty()) warn(stage, changes);
  tell_of_ended_copy(kOfflineFrame);
}

void ExecutionContext::tell_of_ended_copy(std::uint64_t run_frame) const {
  const std::string maker = maker_of_ended_copy();
  if (maker.empty() || !log_) return;
  log_(maker, kWarning,
       "made a copy of the process with fork() and returned in it; the copy was ended", run_frame);
}

void ExecutionContext::warn(const std::string& stage, const std::string& text) const {
  if (log_) log_(stage, kWarning, text, kOfflineFrame);
}

std::int32_t ExecutionContext::call_here(Instance& instance, const weft_call& call,
                                         std::span<const weft_record> inputs,
                                         std::uint64_t run_frame, weft_error& error) const {
  bool kept_mode = true;
  const auto process = [&] {
    return instance.table->process(instance.self, &call, inputs.data(), inputs.size(), &error);
  };
  std::optional<ProcessState> before;
  if (instance.is_watched) before.emplace();
  const std::int32_t status = call_library(instance.id.c_str(), error, process, &kept_mode);
  const std::string changes = before ? before->restore("in a call") : "";
  instance.is_watched = !changes.empty();
  if (instance.is_watched && log_) log_(instance.name, kWarning, changes, run_frame);
  tell_of_ended_copy(run_frame);
  constexpr const char* kChanged = "left the floating-point mode changed; it was set back";
  if (!kept_mode && log_) log_(instance.name, kWarning, kChanged, run_frame);
  return status;
}

Outcome ExecutionContext::finish(Instance& instance, Scope& scope,
                                 std::span<const weft_record> inputs, std::int32_t status,
                                 const weft_error& error) {
  const auto broken = [&](const std::string& message) {
    const std::string why = scope.refusal.empty() ? "" : "; " + scope.refusal;
    return Outcome{WEFT_ERROR, {Errc::plugin_failure, message + why, instance.id}, {}};
  };
  Outcome outcome;
  outcome.status = status_of(status);
  outcome.error = plugin_error(status, error, instance.id);
  if (outcome.status == WEFT_ERROR && !scope.refusal.empty())
    outcome.error.message += "; " + scope.refusal;
  if (!outcome.usable()) return outcome;
  outcome.outputs = NamedRecords(memory_);
  outcome.outputs.reserve(scope.outputs.size());
  for (auto& [slot, record] : scope.outputs) {
    auto valid = admit(*record, slot.c_str(), instance.record_types);
    if (valid) valid = check_lengths(record->view(slot.c_str()), inputs);
    if (valid) valid = check_values(record->view(slot.c_str()));
    if (!valid) return broken("returned an illegal output: " + valid.error().message);
    const bool was_called_here = instance.table != nullptr;
    if (was_called_here && instance.rules.solves) judge_shape(*record, inputs, instance.evidence);
    record->forget_replaced();
    if (record->frame() == WEFT_NO_FRAME) {
      record->set_frame(static_cast<std::int64_t>(scope.turn.frame));
    }
    if (record->type() == Warp::kType) record->set_producer(instance.handle);
    outcome.outputs.emplace_back(std::move(slot), std::move(record));
  }
  for (const RoleSlot& output : scope.method->outputs) {
    if (must_produce(instance, output) && outcome.find(output.name) == nullptr) {
      return broken("did not produce its output '" + output.name + "'");
    }
  }
  return outcome;
}

const RecordSchema* schema_of(const Record& record, std::span<const RecordSchema> declared) {
  if (record.schema() != nullptr) return record.schema();
  const auto found = std::find_if(declared.begin(), declared.end(), [&](const RecordSchema& each) {
    return each.type == record.type();
  });
  return found != declared.end() ? &*found : nullptr;
}

Result<void> ExecutionContext::admit(Record& record, const char* slot,
                                     std::span<const RecordSchema> types) {
  const RecordSchema* schema = schema_of(record, types);
  auto valid =
      schema != nullptr ? validate(record.view(slot), *schema) : validate(record.view(slot));
  if (!valid) return valid;
  const bool of_content = record.type() == Template::kType || record.type() == Camera::kType;
  record.set_revision(of_content ? content_revision(record) : next_revision() | revision_mark_);
  return {};
}

Instance* ExecutionContext::find(std::uint64_t handle) const {
  const std::lock_guard lock(instances_mutex_);
  return handle >= 1 && handle <= instances_.size() ? instances_[handle - 1].get() : nullptr;
}

std::uint64_t handle_of(const Instance& instance) { return instance.handle; }

void ExecutionContext::let_finish(Instance& instance) { instance.is_let_finish = true; }

}  // namespace weft::host
