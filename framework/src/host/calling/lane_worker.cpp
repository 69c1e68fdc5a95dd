// SPDX-License-Identifier: Apache-2.0
// What a lane does for instances that live in a worker.
#include "host/calling/lane_parts.hpp"

namespace weft::host {

using SteadyTime = std::chrono::steady_clock::time_point;  // processes share this clock

Result<void> Lane::open_workplace() {
  if (workplace_ != nullptr) return {};
  if (arena_ == nullptr) {
    return Error{Errc::unsupported, "a stage can be isolated only in a lane with shared memory"};
  }
  const std::shared_ptr<void> block = arena_->allocate(sizeof(std::atomic<bool>));
  if (block == nullptr) return Error{Errc::io, "there is no room in shared memory"};
  auto* cancel = std::construct_at(static_cast<std::atomic<bool>*>(block.get()), false);
  workplace_ = std::make_unique<Workplace>(Workplace{run_seed_,
                                                     threads_a_call_,
                                                     std::make_shared<SharedInputs>(arena_),
                                                     {block, cancel},
                                                     [this] { return is_cancelled(); },
                                                     log_});
  return {};
}

Result<Instance*> Lane::instantiate_isolated(const ComponentSpec& spec, const std::string& stage,
                                             const Isolation& isolation) {
  if (is_cancelled()) {
    return Error{Errc::cancelled, "cancelled before it began", spec.component().id};
  }
  announce(stage, spec.component().id, "load", kOfflineFrame);
  if (auto open = open_workplace(); !open) return open.error();
  Instance& instance = add(std::make_unique<Instance>(spec, stage, ""));
  const CreateMessage create{instance.handle, stage, "", Recipe::of(spec)};
  if (instance.rules.samples) instance.recreate = create;
  Workplace workplace = *workplace_;
  workplace.run_seed = run_seed_;
  instance.worker = std::make_unique<Worker>(isolation, std::move(workplace), create);
  if (auto started = instance.worker->start(); !started) return started.error();
  return &instance;
}

std::int32_t Lane::call_worker(Instance& instance, Scope& scope, int method,
                               std::span<const weft_record> inputs, weft_error* error) {
  for (const weft_record& input : inputs) {
    const Instance* producer = find(input.producer);
    if (producer == nullptr || !producer->recreate) continue;
    const auto known = instance.worker->learn(*producer->recreate);
    if (!known) return report(known.error(), error);
  }
  auto answer = instance.worker->process(method, scope.turn.frame, scope.turn.draw, inputs);
  if (!answer) return report(answer.error(), error);
  for (const PlacedTiming& timing : answer->timings) {
    note({timing.component,
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
  return answer->status;
}

}  // namespace weft::host
