// SPDX-License-Identifier: Apache-2.0
// Functions of the host that a component may call during a call.
#include <unistd.h>
#include <weft/budget.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <weft/core/quote.hpp>
#include <weft/core/version.hpp>

#include "host/calling/execution_context_parts.hpp"
#include "host/guarding/first_sizes.hpp"
#include "host/loading/arguments.hpp"

namespace weft::host {

bool ExecutionContext::Scope::may_produce(std::string_view slot, std::string_view type) const {
  return method != nullptr &&
         std::any_of(method->outputs.begin(), method->outputs.end(), [&](const RoleSlot& output) {
           return output.name == slot && output.type == type;
         });
}

bool ExecutionContext::Scope::may_invoke(const Instance& target) const {
  const std::vector<Instance*>& own = instance.nested;
  if (std::find(own.begin(), own.end(), &target) != own.end()) return true;
  const auto is_from_target = [&](const weft_record& record) {
    return record.producer == target.handle;
  };
  if (std::any_of(inputs.begin(), inputs.end(), is_from_target)) return true;
  return std::any_of(nested.begin(), nested.end(), [&](const NestedAnswer& answer) {
    return std::any_of(answer.views.begin(), answer.views.end(), is_from_target);
  });
}

namespace {

constexpr std::uint64_t kMostArrays = 1000;       ///< maximum per record
constexpr std::size_t kLongestText_bytes = 4096;  ///< maximum of one log message
constexpr int kMostTexts = 100;                   ///< maximum of log messages in one call

/// [bytes] limit for all arrays of a record: far more than a frame needs, but little enough that
/// other programs do not suffer.
std::int64_t most_bytes() {
  constexpr std::int64_t kMost = std::int64_t{2} << 30U;
  static const std::int64_t kQuarter =
      std::max<std::int64_t>(sysconf(_SC_PHYS_PAGES), 0) / 4 * sysconf(_SC_PAGESIZE);
  return kQuarter > 0 ? std::min(kMost, kQuarter) : kMost;
}

/// The reason why a record has no room for a legal array, or an empty text.
std::string no_room(const Record& record, const weft_output& output, weft_memory memory) {
  const std::int64_t own =
      memory == WEFT_DEVICE ? 0 : array_bytes(output.dtype, output.ndim, output.shape);
  const weft_record view = record.view("");
  std::int64_t others = record.replaced_bytes();
  std::uint64_t count = 1;
  for (std::uint64_t i = 0; i < view.count; ++i) {
    const weft_array& array = view.arrays[i];
    if (array.memory != WEFT_DEVICE) others += array_bytes(array.dtype, array.ndim, array.shape);
    if (std::string_view(array.name) != output.array) ++count;
  }
  if (count > kMostArrays) return "a record may have " + std::to_string(kMostArrays) + " arrays";
  if (own <= most_bytes() - others) return {};
  return "the arrays of a record may have " + std::to_string(most_bytes()) +
         " bytes together, and this one has " + std::to_string(own);
}

/// The reason why a requested array is illegal in its record, or an empty text. Validation after
/// the call would end it: a component that is refused at once can use another array.
std::string illegality_of(const Record& record, const weft_output& output, weft_memory memory,
                          const Instance& maker) {
  if (array_bytes(output.dtype, output.ndim, output.shape) < 0)
    return "its type or shape is illegal, or too large";
  if (!is_legal_name(output.array)) {
    return "its name is not 1 to 100 letters, digits, '_', '-' and '.'";
  }
  weft_array array =
      array_at(output.array, output.dtype, output.ndim, output.shape, nullptr, memory);
  array.data = &array;  // its layout is checked, not its content
  array.handle = output.handle;
  const RecordSchema* schema = schema_of(record, maker.record_types);
  const std::string problem = schema != nullptr ? illegal_array(*schema, array) : "";
  return problem.empty() ? "" : "it " + problem;
}

/// A text of a component as it can be shown: escaped, and not too long.
std::string legible(const char* text) {
  std::size_t length = strnlen(text, kLongestText_bytes + 1);
  if (length <= kLongestText_bytes) return escaped({text, length});
  --length;
  while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xC0U) == 0x80U) --length;
  return escaped({text, length}) + "... (cut at " + std::to_string(kLongestText_bytes) + " bytes)";
}

}  // namespace

/// The functions behind weft_host; none throws.
struct Callbacks {
  static ExecutionContext::Scope& scope_of(const weft_call* call) {
    return *static_cast<ExecutionContext::Scope*>(call->context);
  }

  /// The output record of a call that an array belongs to; null if there is no such output.
  static Record* record_of(ExecutionContext::Scope& scope, const weft_output& output) {
    const bool is_complete = output.struct_size >= kFirstSize<weft_output> &&
                             output.slot != nullptr && output.type != nullptr &&
                             output.array != nullptr;
    if (!is_complete) return nullptr;
    for (auto& [name, record] : scope.outputs) {
      if (name == output.slot && record->type() == output.type) return record.get();
    }
    if (!scope.may_produce(output.slot, output.type)) return nullptr;
    scope.outputs.emplace_back(
        output.slot, Record::make(output.type, scope.context.memory_, scope.context.arena_));
    return scope.outputs.back().second.get();
  }

  /// The record of a requested array; null if the host refuses the array. The first reason is
  /// reported if the call fails.
  static Record* accepting(ExecutionContext::Scope& scope, const weft_output& output,
                           weft_memory memory) {
    if (output.view != 0 || output.object != 0 || output.frame < WEFT_NO_FRAME) {
      refuse(scope, "the host refused an output of view " + std::to_string(output.view) +
                        ", object " + std::to_string(output.object) + " and frame " +
                        std::to_string(output.frame));
      return nullptr;
    }
    Record* record = record_of(scope, output);
    if (record == nullptr) return nullptr;
    std::string reason = illegality_of(*record, output, memory, scope.instance);
    const bool is_legal = reason.empty();
    if (is_legal) reason = no_room(*record, output, memory);
    if (!reason.empty()) {
      refuse(scope, "the host refused its array " + quote(output.array) + " of " +
                        std::string(record->type()) + ": " + reason);
      if (is_legal) warn_once(scope);
      return nullptr;
    }
    if (output.frame != WEFT_NO_FRAME) record->set_frame(output.frame);
    return record;
  }

  static void refuse(ExecutionContext::Scope& scope, std::string refusal) {
    if (scope.refusal.empty()) scope.refusal = std::move(refusal);
  }

  /// Logs a refusal that no component can foresee.
  static void warn_once(ExecutionContext::Scope& scope) {
    if (std::exchange(scope.has_warned, true) || !scope.context.log_) return;
    scope.context.log_(scope.instance.name, kWarning, scope.refusal, scope.turn.run_frame);
  }

  static void* alloc(const weft_call* call, const weft_output* output) try {
    Record* record = accepting(scope_of(call), *output, WEFT_HOST);
    if (record == nullptr) return nullptr;
    return record->allocate(output->array, output->dtype, output->ndim, output->shape);
  } catch (...) {
    return nullptr;
  }

  static std::int32_t adopt(const weft_call* call, const weft_output* output) try {
    ExecutionContext::Scope& scope = scope_of(call);
    const weft_device_memory* library = scope.instance.device_memory;
    if (library == nullptr) {
      refuse(scope,
             "it has no device_memory table, and so cannot deliver an array in device memory");
      return 0;
    }
    Record* record = accepting(scope, *output, WEFT_DEVICE);
    return record != nullptr &&
                   record->adopt(output->array, output->dtype, output->ndim, output->shape,
                                 *library, output->handle, scope.instance.id)
               ? 1
               : 0;
  } catch (...) {
    return 0;
  }

  static std::int32_t cancelled(const weft_call* call) {
    const ExecutionContext::Scope& scope = scope_of(call);
    return !scope.instance.is_let_finish && scope.context.cancellation().is_requested() ? 1 : 0;
  }

  static void log(const weft_call* call, std::int32_t level, const char* text) try {
    ExecutionContext::Scope& scope = scope_of(call);
    if (!scope.context.log_ || text == nullptr) return;
    const std::lock_guard lock(scope.logging);  // the last text is the one about dropped ones
    if (scope.texts > kMostTexts) return;
    const std::string shown =
        scope.texts++ < kMostTexts ? legible(text) : "further messages are dropped";
    scope.context.log_(scope.instance.name, std::clamp(level, 0, kWarning), shown,
                       scope.turn.run_frame);
  } catch (...) {
    return;  // a message is not worth a crash
  }

  static std::int32_t invoke(const weft_call* call, weft_invocation* asked, weft_error* error) try {
    ExecutionContext::Scope& scope = scope_of(call);
    if (asked->struct_size < kFirstSize<weft_invocation>) {
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
    if (!scope.may_invoke(*target)) {
      return report({Errc::invalid_value,
                     "called '" + target->name.str() +
                         "', which is not nested in it and made none of its warps",
                     {}},
                    error);
    }
    NestedAnswer& answer = scope.nested.emplace_front(NestedAnswer{
        scope.context.enter(*target, asked->method, {asked->inputs, asked->input_count},
                            {asked->frame, asked->draw, scope.turn.run_frame, scope.turn.depth + 1,
                             scope.turn.threads, scope.turn.deadline}),
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

  static double left_ms(const weft_call* call) {
    const SteadyTime deadline = scope_of(call).turn.deadline;
    if (deadline == kNoDeadline) return std::numeric_limits<double>::infinity();
    return std::chrono::duration<double, std::milli>(deadline - SteadyTime::clock::now()).count();
  }

  static const void* extension(const weft_host* /*host*/, void* /*context*/, const char* name) {
    static constexpr weft_budget kBudget{sizeof(weft_budget), 0, &left_ms};
    return name != nullptr && std::string_view(name) == WEFT_BUDGET ? &kBudget : nullptr;
  }
};

const weft_host& host_table() {
  static constexpr weft_host kHost{
      sizeof(weft_host),  WEFT_ABI_MAJOR,    WEFT_ABI_MINOR,        kHostName,
      kVersion,           &Callbacks::alloc, &Callbacks::cancelled, &Callbacks::log,
      &Callbacks::invoke, &Callbacks::adopt, &Callbacks::extension};
  return kHost;
}

}  // namespace weft::host
