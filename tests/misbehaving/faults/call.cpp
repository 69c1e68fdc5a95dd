// SPDX-License-Identifier: Apache-2.0
// The host that a plugin sees: functions that record each request and call the real host.
#include <algorithm>

#include "faults.hpp"

namespace weft::faults {
namespace {

const PassedCall& passed_of(const weft_call* call) {
  return *reinterpret_cast<const PassedCall*>(call);
}

/// Arrays that must have as many rows as others of their record.
bool goes_with_others(std::string_view array) {
  constexpr std::string_view kNames[] = {"score",  "angle_rad", "source",
                                         "weight", "reason",    "valid"};
  return std::find(std::begin(kNames), std::end(kNames), array) != std::end(kNames);
}

void remember(PassedCall& passed, Output output) {
  if (has("reads_uninitialised") || has("last_row_unwritten")) {
    output.before.assign(output.data, output.data + output.bytes());
  }
  for (Output& earlier : passed.outputs) {
    if (earlier.slot != output.slot || earlier.array != output.array) continue;
    earlier = std::move(output);
    return;
  }
  passed.outputs.push_back(std::move(output));
}

void* alloc(const weft_call* call, const weft_output* asked) {
  PassedCall& passed = const_cast<PassedCall&>(passed_of(call));
  Output output{asked->slot,
                asked->type,
                asked->array,
                asked->dtype,
                {asked->shape, asked->shape + asked->ndim},
                nullptr,
                {}};
  if (has("wrong_length") && asked->ndim == 1 && goes_with_others(asked->array)) ++output.shape[0];
  const weft_host& host = *passed.original.host;
  weft_output entry = *asked;
  entry.shape = output.shape.data();
  void* data = host.alloc(&passed.original, &entry);
  if (has("writes_to_null")) *static_cast<volatile unsigned char*>(data) = 0;
  if (data == nullptr && has("ok_without_memory")) {
    passed.replacements.emplace_back(output.bytes() + 64);
    return passed.replacements.back().data();
  }
  output.data = static_cast<unsigned char*>(data);
  if (data != nullptr) remember(passed, std::move(output));
  return data;
}

std::int32_t cancelled(const weft_call* call) {
  const PassedCall& passed = passed_of(call);
  return passed.original.host->cancelled(&passed.original);
}

void log(const weft_call* call, std::int32_t level, const char* text) {
  const PassedCall& passed = passed_of(call);
  passed.original.host->log(&passed.original, level, text);
}

std::int32_t invoke(const weft_call* call, weft_invocation* invocation, weft_error* error) {
  const PassedCall& passed = passed_of(call);
  return passed.original.host->invoke(&passed.original, invocation, error);
}

std::int32_t adopt(const weft_call* call, const weft_output* output) {
  const PassedCall& passed = passed_of(call);
  return passed.original.host->adopt(&passed.original, output);
}

}  // namespace

PassedCall::PassedCall(const weft_call& given) : call{}, original(given), host{} {
  std::memcpy(&call, &given, std::min<std::size_t>(given.struct_size, sizeof(call)));
  call.struct_size =
      static_cast<std::uint32_t>(std::min<std::size_t>(given.struct_size, sizeof(call)));
  const weft_host& theirs = *given.host;
  host.abi_major = theirs.abi_major;
  host.abi_minor = theirs.abi_minor;
  host.name = theirs.name;
  host.version = theirs.version;
  host.struct_size =
      static_cast<std::uint32_t>(std::min<std::size_t>(theirs.struct_size, sizeof(host)));
  host.alloc = alloc;
  host.cancelled = cancelled;
  host.log = log;
  host.invoke = invoke;
  host.adopt = adopt;
  // The only function that gets no call as an argument, and the last one of an older host.
  constexpr std::size_t kEnd = offsetof(weft_host, get_extension) + sizeof(void*);
  if (theirs.struct_size >= kEnd) host.get_extension = theirs.get_extension;
  call.host = &host;
}

std::size_t Output::bytes() const {
  std::size_t count = element_bytes(dtype);
  for (const std::int64_t length : shape) count *= static_cast<std::size_t>(length);
  return count;
}

std::size_t Output::row_bytes() const {
  return shape.empty() || shape[0] == 0 ? bytes() : bytes() / static_cast<std::size_t>(shape[0]);
}

}  // namespace weft::faults
