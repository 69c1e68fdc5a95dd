// SPDX-License-Identifier: Apache-2.0
// Functions of an execution context for runs whose parameters change, and for its end.
#include "host/calling/execution_context_parts.hpp"
#include "host/guarding/library_call.hpp"
#include "host/guarding/process_state.hpp"
#include "host/records/plugin_error.hpp"

namespace weft::host {
namespace {

const weft_steering* steering_of(const Instance& sink) {
  if (sink.table == nullptr) return nullptr;
  const auto found = extension_of<weft_steering>(*sink.table, WEFT_STEERING);
  const weft_steering* steering = found ? *found : nullptr;
  const bool usable = steering != nullptr && steering->take_change_requests != nullptr &&
                      steering->answer != nullptr;
  return usable ? steering : nullptr;
}

}  // namespace

ExecutionContext::~ExecutionContext() {
  memory_->close();
  for (std::unique_ptr<Instance>& instance : instances_) {
    if (instance != nullptr) end(*instance);
    instance.reset();
  }
}

void ExecutionContext::replace(Instance& old, Instance& made) {
  auto in_place = take_out(made);
  auto gone = take_out(old);
  in_place->handle = gone->handle;
  {
    const std::lock_guard lock(instances_mutex_);
    instances_[in_place->handle - 1] = std::move(in_place);
  }
  destroy(std::move(gone));
}

void ExecutionContext::discard(Instance& instance) { destroy(take_out(instance)); }

std::unique_ptr<Instance> ExecutionContext::take_out(Instance& instance) {
  const std::lock_guard lock(instances_mutex_);
  return std::move(instances_[instance.handle - 1]);
}

std::string Instance::end() {
  if (self == nullptr) return {};
  weft_error error = kNoError;
  void* const ended = std::exchange(self, nullptr);
  const std::int32_t status = call_library(id.c_str(), error, [&] { table->destroy(ended); });
  return status == WEFT_OK ? "" : plugin_error(status, error, id).message;
}

void ExecutionContext::end(Instance& instance) const {
  const Announced announced{*this, instance.name, instance.id, "destroy", kOfflineFrame};
  const ProcessState before;
  const std::string fault = instance.end();
  warn_of_changes(before, instance.name, "while it was destroyed");
  if (!fault.empty()) warn(instance.name, "its destroy() " + fault);
}

/// Those nested in it after it: it may call them until it is gone.
void ExecutionContext::destroy(std::unique_ptr<Instance> instance) {
  const std::vector<Instance*> nested = instance->nested;
  end(*instance);
  instance.reset();
  for (Instance* each : nested) destroy(take_out(*each));
}

bool ExecutionContext::steers(const Instance& sink) { return steering_of(sink) != nullptr; }

Result<std::vector<ChangeRequest>> ExecutionContext::take_change_requests(const Instance& sink) {
  std::vector<ChangeRequest> requests;
  const auto note = [](void* context, std::uint64_t number, const char* text) {
    if (text == nullptr) return;
    static_cast<std::vector<ChangeRequest>*>(context)->push_back({number, text});
  };
  weft_error error = kNoError;
  const auto status = call_library(sink.id.c_str(), error, [&] {
    return steering_of(sink)->take_change_requests(sink.self, &requests, note, &error);
  });
  if (status != WEFT_OK) return plugin_error(status, error, sink.id);
  return requests;
}

Result<void> ExecutionContext::answer(const Instance& sink, const ChangeAnswer& answer) {
  weft_error error = kNoError;
  const auto status = call_library(sink.id.c_str(), error, [&] {
    return steering_of(sink)->answer(sink.self, answer.number, answer.frame, answer.refusal.c_str(),
                                     &error);
  });
  if (status != WEFT_OK) return plugin_error(status, error, sink.id);
  return {};
}

}  // namespace weft::host
