// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstring>
#include <optional>
#include <string_view>
#include <vector>
#include <weft/core/params.hpp>
#include <weft/core/quote.hpp>
#include <weft/data/codec.hpp>
#include <weft/sdk/call.hpp>
#include <weft/sdk/optional_input.hpp>

namespace weft {

/// Properties of a component, as `static constexpr weft::About kAbout{...}` in its class.
struct About {
  const char* reference = "";          ///< paper or standard
  const char* licence = "Apache-2.0";  ///< SPDX id of the built library
  const char* determinism = "exact";   ///< "exact" or "tolerance"
  const char* needs = "";              ///< inputs required beyond those of the role
  const char* reads = "";              ///< inputs used when present
  const char* produces = "";           ///< outputs, where the role leaves a choice
  bool random = false;                 ///< draws from the seed
  bool uses_truth = false;             ///< may read ground_truth
  /// Device memory of the library's arrays, see weft/sdk/device.hpp.
  const weft_device_memory* device_memory = nullptr;
};

/// The parameter that determines the strictness of a component, with values that a plan sweeps for
/// a ROC curve. Declare `static constexpr weft::Sweep kSweep{"alpha_s", {0.01, 0.1, 1}}` in the
/// class.
template <std::size_t Count>
struct Sweep {
  const char* parameter;
  double values[Count];  ///< ascending; larger values may be less strict
};
template <std::size_t Count>
Sweep(const char*, const double (&)[Count]) -> Sweep<Count>;

/// Copies text into a fixed buffer, cut at a UTF-8 character boundary; NUL is escaped.
template <std::size_t Size>
void copy_text(char (&target)[Size], std::string_view given) {
  const std::string text = without_nul(given);
  std::size_t length = std::min(text.size(), Size - 1);
  while (length > 0 && length < text.size() &&
         (static_cast<unsigned char>(text[length]) & 0xC0U) == 0x80U) {
    --length;
  }
  std::memcpy(target, text.data(), length);
  target[length] = '\0';
}

/// An empty error for the callee to fill.
inline constexpr weft_error kNoError{sizeof(weft_error), 0, {}, {}, {}};

/// Writes an Error into the caller's buffer and returns its status.
inline std::int32_t report(const Error& error, weft_error* target) {
  target->code = static_cast<std::int32_t>(error.code);
  copy_text(target->where, error.where);
  copy_text(target->message, error.message);
  copy_text(target->subject, error.subject);
  if (error.code == Errc::no_result) return WEFT_NO_RESULT;
  if (error.code == Errc::end) return WEFT_END;
  return error.code == Errc::cancelled ? WEFT_CANCELLED : WEFT_ERROR;
}

/// One process() call: converts records into a role's typed input and its answer into records.
class ProcessCall {
 public:
  ProcessCall(const weft_call& call, const weft_record* inputs, std::uint64_t count,
              weft_error* error)
      : call_(call), inputs_(inputs), count_(count), error_(error) {}

  int method() const { return call_.method; }

  /// Reads `Input`, calls `body(input)` and writes its Result as output `slot`.
  template <class Input, class Body>
  std::int32_t run(const char* slot, Body&& body) {
    return run_with<Input>(body, [&](const auto& value) { return write(slot, value); });
  }

  /// Like run(), except that `store(value)` writes the outputs with write().
  template <class Input, class Body, class Store>
  std::int32_t run_with(Body&& body, Store&& store) {
    Input input{Call(call_)};
    if (auto read = read_slots(input); !read) return report(read.error(), error_);
    auto result = body(input);
    if (!result) return report(result.error(), error_);
    if constexpr (requires { *result; }) {
      if (Result<void> stored = store(*result); !stored) return report(stored.error(), error_);
      if (!result.degenerate_reason().empty()) {
        copy_text(error_->message, result.degenerate_reason());
        return WEFT_DEGENERATE;
      }
    }
    return WEFT_OK;
  }

  template <class RecordType>
  Result<void> write(const char* slot, const RecordType& typed) const {
    return write_record(
        typed, Output{call_, slot, RecordType::kType, typed.others.view(), typed.others.object()});
  }
  template <class RecordType>
  Result<void> write(const char* slot, const std::optional<RecordType>& typed) const {
    return typed ? write(slot, *typed) : Result<void>{};
  }

  /// Fills the slots of a role's input from the records of the call.
  template <class Input>
  Result<void> read_slots(Input& input) const {
    Result<void> status;
    Input::slots(input, [&](const char* slot, auto& member) {
      if (auto read = status ? read_slot(slot, member) : Result<void>{}; !read) status = read;
    });
    return status;
  }

 private:
  /// Destination of an output's arrays.
  struct Output {
    const weft_call& call;
    const char *slot, *type;
    std::int32_t view, object;

    void* operator()(const char* array, std::int32_t dtype, int ndim,
                     const std::int64_t* shape) const {
      const weft_output output = entry(array, dtype, ndim, shape, 0);
      return call.host->alloc(&call, &output);
    }
    bool adopt(const char* array, std::int32_t dtype, int ndim, const std::int64_t* shape,
               std::uint64_t handle) const {
      const weft_output output = entry(array, dtype, ndim, shape, handle);
      return call.host->adopt(&call, &output) != 0;
    }
    weft_output entry(const char* array, std::int32_t dtype, int ndim, const std::int64_t* shape,
                      std::uint64_t handle) const {
      return {sizeof(weft_output), dtype, slot, type, array, shape, ndim, view, object, 0,
              WEFT_NO_FRAME,       handle};
    }
  };

  template <class RecordType>
  Result<void> read_slot(const char* slot, RecordType& member) const {
    for (std::uint64_t i = 0; i < count_; ++i) {
      if (is_in(inputs_[i], slot)) return read_into(inputs_[i], member);
    }
    return Error{Errc::invalid_data, std::string("required input '") + slot + "' is absent"};
  }
  template <class RecordType>
  Result<void> read_slot(const char* slot, OptionalInput<RecordType>& member) const {
    member.call_it(slot);
    for (std::uint64_t i = 0; i < count_; ++i) {
      if (is_in(inputs_[i], slot)) return read_into(inputs_[i], member.emplace());
    }
    return {};
  }
  template <class RecordType>
  Result<void> read_slot(const char* slot, ListInput<RecordType>& members) const {
    members.call_it(slot);
    for (std::uint64_t i = 0; i < count_; ++i) {
      if (!is_in(inputs_[i], slot)) continue;
      if (auto read = read_into(inputs_[i], members.emplace_back()); !read) return read;
    }
    return {};
  }
  static bool is_in(const weft_record& input, const char* slot) {
    return std::strcmp(input.slot, slot) == 0;
  }
  template <class RecordType>
  static Result<void> read_into(const weft_record& record, RecordType& member) {
    auto typed = read_record<RecordType>(record);
    if (!typed) return typed.error();
    member = *std::move(typed);
    return {};
  }

  const weft_call& call_;
  const weft_record* inputs_;
  std::uint64_t count_;
  weft_error* error_;
};

/// Input of prepare(), which the host calls once before the first frame, except for sources and
/// templates.
struct PrepareInput {
  Call call;
  Template templ{};
  Camera camera{};

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("template", self.templ);
    visit("camera", self.camera);
  }
};

}  // namespace weft
