// SPDX-License-Identifier: Apache-2.0
// Functions of an execution context for instances that live in a worker.
#include "host/calling/execution_context_parts.hpp"

namespace weft::host {

Result<WorkerContext> ExecutionContext::worker_context_of(const Instance& instance) {
  if (arena_ == nullptr) {
    return Error{Errc::unsupported,
                 "a stage can be isolated only in an execution context with shared memory"};
  }
  if (inputs_of_workers_ == nullptr) inputs_of_workers_ = std::make_shared<SharedInputs>(arena_);
  const std::shared_ptr<void> block = arena_->allocate(sizeof(std::atomic<bool>));
  if (block == nullptr) return no_room_in_shared_memory("workers");
  auto* cancel = std::construct_at(static_cast<std::atomic<bool>*>(block.get()), false);
  return WorkerContext{
      run_seed_,
      threads_.equal(),
      inputs_of_workers_,
      {block, cancel},
      [this, &instance] { return !instance.is_let_finish && cancellation_.is_requested(); },
      log_};
}

Result<Instance*> ExecutionContext::instantiate_isolated(const ComponentSpec& spec,
                                                         const std::string& stage,
                                                         const Isolation& isolation) {
  if (cancellation_.is_requested()) {
    return Error{Errc::cancelled, "cancelled before it began", spec.component().id};
  }
  const Announced announced{*this, stage, spec.component().id, "load", kOfflineFrame};
  Instance& instance = add(std::make_unique<Instance>(spec, stage, ""));
  auto context = worker_context_of(instance);
  if (!context) return context.error();
  const CreateMessage create{instance.handle, stage, "", Recipe::of(spec)};
  if (instance.rules.samples) instance.recreate = create;
  Isolation how = isolation;
  // A camera cannot be opened twice at once.
  how.keeps_spare = how.keeps_spare && instance.rules.part == PipelinePart::stage;
  how.starts_again = how.starts_again && instance.rules.part != PipelinePart::sink;
  instance.worker = std::make_unique<Worker>(how, *std::move(context), create);
  if (auto started = instance.worker->start(); !started) return started.error();
  return &instance;
}

std::int32_t ExecutionContext::call_worker(Instance& instance, Scope& scope, int method,
                                           std::span<const weft_record> inputs, weft_error* error) {
  for (const weft_record& input : inputs) {
    const Instance* producer = find(input.producer);
    if (producer == nullptr || !producer->recreate) continue;
    const auto known = instance.worker->learn(*producer->recreate);
    if (!known) return report(known.error(), error);
  }
  auto answer = instance.worker->process(method, scope.turn.frame, scope.turn.draw, inputs,
                                         scope.turn.deadline);
  if (!answer) return report(answer.error(), error);
  for (const PlacedTiming& timing : answer->timings) {
    times_.note({timing.component,
                 {timing.ms, timing.processor_ms},
                 SteadyTime(std::chrono::nanoseconds(timing.start_ns)),
                 timing.method,
                 scope.turn.run_frame,
                 status_of(timing.status),
                 instance.stage,
                 timing.downloaded_bytes});
  }
  scope.downloaded_bytes += answer->downloaded_bytes;
  scope.worker_processor_ms += answer->processor_ms;
  for (auto& [slot, record] : answer->outputs) {
    if (!scope.may_produce(slot, record->type())) {
      return report(
          {Errc::plugin_failure, "its worker returned what its role does not produce", {}}, error);
    }
    scope.outputs.emplace_back(slot, std::move(record));
  }
  if (answer->status != WEFT_OK) report(answer->error, error);
  if (answer->status == WEFT_OK && instance.rules.part == PipelinePart::source &&
      method == kOpenSource) {
    instance.worker->begin_with(method, scope.turn.frame);
  }
  return answer->status;
}

}  // namespace weft::host
