// SPDX-License-Identifier: Apache-2.0
// What a component may ask of its host during a call.
#include <algorithm>

#include "host/calling/lane_parts.hpp"

namespace weft::host {

bool Lane::Scope::may_produce(std::string_view slot, std::string_view type) const {
  return method != nullptr &&
         std::any_of(method->outputs.begin(), method->outputs.end(), [&](const RoleSlot& output) {
           return output.name == slot && output.type == type;
         });
}

/// The functions behind weft_host; none throws.
struct Callbacks {
  /// The output record of a call that an array belongs to; null when there is no such output.
  static Record* output(const weft_call* call, const char* slot, const char* type,
                        const char* array) {
    auto& scope = *static_cast<Lane::Scope*>(call->context);
    if (slot == nullptr || type == nullptr || array == nullptr) return nullptr;
    for (auto& [name, record] : scope.outputs) {
      if (name == slot && record->type() == type) return record.get();
    }
    if (!scope.may_produce(slot, type)) return nullptr;
    scope.outputs.emplace_back(slot, Record::make(type, scope.lane.memory_, scope.lane.arena_));
    return scope.outputs.back().second.get();
  }

  static void* alloc(const weft_call* call, const char* slot, const char* type, const char* array,
                     std::int32_t dtype, std::int32_t ndim, const std::int64_t* shape) try {
    Record* record = output(call, slot, type, array);
    return record != nullptr ? record->allocate(array, dtype, ndim, shape) : nullptr;
  } catch (...) {
    return nullptr;
  }

  static std::int32_t adopt(const weft_call* call, const char* slot, const char* type,
                            const char* array, std::int32_t dtype, std::int32_t ndim,
                            const std::int64_t* shape, std::uint64_t handle) try {
    auto& scope = *static_cast<Lane::Scope*>(call->context);
    const weft_device_memory* library = scope.instance.device_memory;
    if (library == nullptr) {
      scope.refusal = "it names no device_memory of its own, and so cannot leave an array there";
    }
    Record* record = library != nullptr ? output(call, slot, type, array) : nullptr;
    return record != nullptr &&
                   record->adopt(array, dtype, ndim, shape, *library, handle, scope.instance.id)
               ? 1
               : 0;
  } catch (...) {
    return 0;
  }

  static std::int32_t cancelled(const weft_call* call) {
    const auto& scope = *static_cast<Lane::Scope*>(call->context);
    return !scope.instance.is_let_finish && scope.lane.is_cancelled() ? 1 : 0;
  }

  static void log(const weft_call* call, std::int32_t level, const char* text) try {
    auto& scope = *static_cast<Lane::Scope*>(call->context);
    if (scope.lane.log_) scope.lane.log_(scope.instance.name, level, text, scope.turn.run_frame);
  } catch (...) {
    return;  // a message is not worth a crash
  }

  static std::int32_t invoke(const weft_call* call, weft_invocation* asked, weft_error* error) try {
    auto& scope = *static_cast<Lane::Scope*>(call->context);
    if (asked->struct_size < sizeof(weft_invocation)) {
      return report({Errc::incompatible, "gave a weft_invocation that is too short", {}}, error);
    }
    Instance* target = scope.lane.find(asked->component);
    if (target == nullptr) {
      return report({Errc::not_found,
                     "no component has the handle " + std::to_string(asked->component) +
                         "; was the warp made by this pipeline?",
                     {}},
                    error);
    }
    NestedAnswer& answer = scope.nested.emplace_front(NestedAnswer{
        scope.lane.enter(*target, asked->method, {asked->inputs, asked->input_count},
                         {asked->frame, asked->draw, scope.turn.run_frame, scope.turn.depth + 1}),
        PooledVector<weft_record>(scope.lane.memory_)});
    const Outcome& outcome = answer.outcome;
    answer.views.reserve(outcome.outputs.size());
    for (const auto& [slot, record] : outcome.outputs) {
      answer.views.push_back(record->view(slot.c_str()));
    }
    const auto readable = answer.reached.reach(answer.views, scope.instance.device_memory, *call);
    scope.downloaded_bytes += outcome.downloaded_bytes + answer.reached.downloaded_bytes();
    scope.worker_processor_ms += outcome.worker_processor_ms;
    if (!readable) return report(readable.error(), error);
    asked->outputs = readable->data();
    asked->output_count = readable->size();
    if (outcome.status != WEFT_OK) report(outcome.error, error);
    return outcome.status;
  } catch (...) {
    return report({Errc::plugin_failure, "the host is out of memory", {}}, error);
  }
};

const weft_host& host_table() {
  static constexpr weft_host kHost{sizeof(weft_host), 0,
                                   &Callbacks::alloc, &Callbacks::cancelled,
                                   &Callbacks::log,   &Callbacks::invoke,
                                   &Callbacks::adopt, &host_extension};
  return kHost;
}

}  // namespace weft::host
