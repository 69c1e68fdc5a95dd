// SPDX-License-Identifier: Apache-2.0
// Functions of the host that a component may call during a call.
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <weft/core/quote.hpp>

#include "host/calling/execution_context_parts.hpp"

namespace weft::host {

bool ExecutionContext::Scope::may_produce(std::string_view slot, std::string_view type) const {
  return method != nullptr &&
         std::any_of(method->outputs.begin(), method->outputs.end(), [&](const RoleSlot& output) {
           return output.name == slot && output.type == type;
         });
}

namespace {

constexpr std::uint64_t kMostArrays = 1000;       ///< maximum per record
constexpr std::size_t kLongestText_bytes = 4096;  ///< maximum of one log message

/// [bytes] limit for all arrays of a record: far more than a frame needs, but little enough that
/// other programs do not suffer.
std::int64_t most_bytes() {
  constexpr std::int64_t kMost = std::int64_t{2} << 30U;
  static const std::int64_t kQuarter =
      std::max<std::int64_t>(sysconf(_SC_PHYS_PAGES), 0) / 4 * sysconf(_SC_PAGESIZE);
  return kQuarter > 0 ? std::min(kMost, kQuarter) : kMost;
}

/// The reason why the host refuses a requested array; empty if it accepts the array.
std::string refusal_of(const Record& record, std::string_view name, std::int32_t dtype,
                       std::int32_t ndim, const std::int64_t* shape) {
  const weft_record view = record.view("");
  const std::int64_t own = array_bytes(dtype, ndim, shape);
  std::int64_t others = 0;
  std::uint64_t count = 1;
  for (std::uint64_t i = 0; i < view.count; ++i) {
    const weft_array& array = view.arrays[i];
    if (array.name == name) continue;
    ++count;
    if (array.memory != WEFT_DEVICE) others += array_bytes(array.dtype, array.ndim, array.shape);
  }
  if (count <= kMostArrays && own >= 0 && own <= most_bytes() - others) return {};
  const std::string what = "the host refused its array " + quote(std::string(name)) + " of " +
                           std::string(record.type());
  if (count > kMostArrays) {
    return what + ": a record may have " + std::to_string(kMostArrays) + " arrays";
  }
  if (own < 0) return what + ": its type or shape is illegal, or too large";
  return what + " (" + std::to_string(own) + " bytes): the arrays of a record may have " +
         std::to_string(most_bytes()) + " bytes together";
}

std::string bounded(const char* text) {
  std::size_t length = strnlen(text, kLongestText_bytes + 1);
  if (length <= kLongestText_bytes) return text;
  --length;
  while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xC0U) == 0x80U) --length;
  return std::string(text, length) + "... (cut at " + std::to_string(kLongestText_bytes) +
         " bytes)";
}

}  // namespace

/// The functions behind weft_host; none throws.
struct Callbacks {
  /// The output record of a call that an array belongs to; null when there is no such output.
  static Record* output(const weft_call* call, const char* slot, const char* type,
                        const char* array) {
    auto& scope = *static_cast<ExecutionContext::Scope*>(call->context);
    if (slot == nullptr || type == nullptr || array == nullptr) return nullptr;
    for (auto& [name, record] : scope.outputs) {
      if (name == slot && record->type() == type) return record.get();
    }
    if (!scope.may_produce(slot, type)) return nullptr;
    scope.outputs.emplace_back(slot,
                               Record::make(type, scope.context.memory_, scope.context.arena_));
    return scope.outputs.back().second.get();
  }

  static void* alloc(const weft_call* call, const char* slot, const char* type, const char* array,
                     std::int32_t dtype, std::int32_t ndim, const std::int64_t* shape) try {
    Record* record = output(call, slot, type, array);
    if (record == nullptr) return nullptr;
    auto& scope = *static_cast<ExecutionContext::Scope*>(call->context);
    std::string refusal = refusal_of(*record, array, dtype, ndim, shape);
    if (refusal.empty()) return record->allocate(array, dtype, ndim, shape);
    if (scope.refusal.empty() && scope.context.log_) {
      scope.context.log_(scope.instance.name, kWarning, refusal, scope.turn.run_frame);
    }
    scope.refusal = std::move(refusal);
    return nullptr;
  } catch (...) {
    return nullptr;
  }

  static std::int32_t adopt(const weft_call* call, const char* slot, const char* type,
                            const char* array, std::int32_t dtype, std::int32_t ndim,
                            const std::int64_t* shape, std::uint64_t handle) try {
    auto& scope = *static_cast<ExecutionContext::Scope*>(call->context);
    const weft_device_memory* library = scope.instance.device_memory;
    if (library == nullptr) {
      scope.refusal =
          "it has no device_memory table, and so cannot deliver an array in device memory";
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
    const auto& scope = *static_cast<ExecutionContext::Scope*>(call->context);
    return !scope.instance.is_let_finish && scope.context.cancellation().is_requested() ? 1 : 0;
  }

  static void log(const weft_call* call, std::int32_t level, const char* text) try {
    auto& scope = *static_cast<ExecutionContext::Scope*>(call->context);
    if (scope.context.log_ && text != nullptr) {
      scope.context.log_(scope.instance.name, level, bounded(text), scope.turn.run_frame);
    }
  } catch (...) {
    return;  // a message is not worth a crash
  }

  static std::int32_t invoke(const weft_call* call, weft_invocation* asked, weft_error* error) try {
    auto& scope = *static_cast<ExecutionContext::Scope*>(call->context);
    if (asked->struct_size < sizeof(weft_invocation)) {
      return report({Errc::incompatible, "gave a weft_invocation that is too short", {}}, error);
    }
    Instance* target = scope.context.find(asked->component);
    if (target == nullptr) {
      return report({Errc::not_found,
                     "no component has the handle " + std::to_string(asked->component) +
                         "; was the warp made by this pipeline?",
                     {}},
                    error);
    }
    NestedAnswer& answer = scope.nested.emplace_front(
        NestedAnswer{scope.context.enter(
                         *target, asked->method, {asked->inputs, asked->input_count},
                         {asked->frame, asked->draw, scope.turn.run_frame, scope.turn.depth + 1}),
                     PooledVector<weft_record>(scope.context.memory_)});
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
