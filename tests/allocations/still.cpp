// SPDX-License-Identifier: Apache-2.0
// Components that answer as another one answered their first call, and allocate nothing for it:
// what a warm frame of them allocates, the host does. Written against the bare contract, so that
// they do not even allocate what the SDK does.
#include <weft/abi.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <list>
#include <string>
#include <vector>

namespace {

/// An array of an answer, with its contents.
struct Kept {
  std::string slot, type, name;
  std::int32_t dtype, ndim;
  std::array<std::int64_t, WEFT_MAX_DIMENSIONS> shape;
  std::vector<char> bytes;
};

struct Still {
  std::uint64_t of = 0;                      ///< the component that it calls
  std::uint8_t asks = 0;                     ///< in each call, instead of keeping its first answer
  std::array<std::list<Kept>, 3> answers{};  ///< by method
  std::array<bool, 3> is_known{};
};

constexpr std::array<std::size_t, 9> kBytes{0, 1, 1, 2, 2, 4, 8, 4, 8};

std::size_t bytes_of(const weft_array& array) {
  std::size_t bytes = kBytes[static_cast<std::size_t>(array.dtype)];
  for (int axis = 0; axis < array.ndim; ++axis) {
    bytes *= static_cast<std::size_t>(array.shape[axis]);
  }
  return bytes;
}

/// Declares `role`, whose default is the component `usual`.
std::int32_t declare(const weft_describe* sink, const char* role, const char* usual) {
  weft_parameter of{};
  of.struct_size = sizeof(of);
  of.default_value = {"of", WEFT_VALUE_COMPONENT, 0, 1, &usual, {}};
  of.unit = of.was = "";
  of.role = role;
  of.help = "whose answer it gives";
  sink->parameter(sink->context, &of);
  weft_parameter asks{};
  asks.struct_size = sizeof(asks);
  const std::uint8_t no = 0;
  asks.default_value = {"asks", WEFT_VALUE_BOOL, 0, 1, &no, {}};
  asks.unit = asks.role = asks.was = "";
  asks.help = "ask it in each call, instead of keeping its first answer";
  sink->parameter(sink->context, &asks);
  return WEFT_OK;
}

std::int32_t create(const weft_create* with, void** self, weft_error*) {
  auto* still = new Still;
  for (std::uint64_t i = 0; i < with->count; ++i) {
    const weft_value& value = with->values[i];
    if (value.type == WEFT_VALUE_BOOL) {
      still->asks = *static_cast<const std::uint8_t*>(value.data);
    } else {
      still->of = *static_cast<const std::uint64_t*>(value.data);
    }
  }
  *self = still;
  return WEFT_OK;
}

std::int32_t prepare(void*, const weft_call*, const weft_record*, std::uint64_t, weft_error*) {
  return WEFT_OK;
}

std::int32_t give(const weft_call* call, const char* slot, const char* type, const char* name,
                  std::int32_t dtype, std::int32_t ndim, const std::int64_t* shape,
                  const void* data, std::size_t bytes) {
  void* target = weft_alloc(call, slot, type, name, dtype, ndim, shape);
  if (target == nullptr) return WEFT_ERROR;
  if (bytes > 0) std::memcpy(target, data, bytes);
  return WEFT_OK;
}

void keep(const weft_record& record, std::list<Kept>& answer) {
  for (std::uint64_t i = 0; i < record.count; ++i) {
    const weft_array& array = record.arrays[i];
    Kept& kept = answer.emplace_back(
        Kept{record.slot, record.type, array.name, array.dtype, array.ndim, {}, {}});
    for (int axis = 0; axis < array.ndim; ++axis) {
      kept.shape[static_cast<std::size_t>(axis)] = array.shape[axis];
    }
    const auto* data = static_cast<const char*>(array.data);
    kept.bytes.assign(data, data + bytes_of(array));
  }
}

std::int32_t process(void* self, const weft_call* call, const weft_record* inputs,
                     std::uint64_t count, weft_error* error) {
  Still& still = *static_cast<Still*>(self);
  const auto method = static_cast<std::size_t>(call->method);
  if (still.asks != 0 || !still.is_known[method]) {
    weft_invocation asked = {
        sizeof(asked), call->method, still.of, inputs, count, call->frame, 0, nullptr, 0};
    const std::int32_t status = call->host->invoke(call, &asked, error);
    if (status != WEFT_OK) return status;
    const weft_record* outputs = asked.outputs;
    still.answers[method].clear();
    for (std::uint64_t i = 0; i < asked.output_count; ++i) {
      if (still.asks == 0) keep(outputs[i], still.answers[method]);
      for (std::uint64_t k = 0; still.asks != 0 && k < outputs[i].count; ++k) {
        const weft_array& array = outputs[i].arrays[k];
        give(call, outputs[i].slot, outputs[i].type, array.name, array.dtype, array.ndim,
             array.shape, array.data, bytes_of(array));
      }
    }
    still.is_known[method] = true;
    if (still.asks != 0) return WEFT_OK;
  }
  for (const Kept& kept : still.answers[method]) {
    const std::int32_t status =
        give(call, kept.slot.c_str(), kept.type.c_str(), kept.name.c_str(), kept.dtype, kept.ndim,
             kept.shape.data(), kept.bytes.data(), kept.bytes.size());
    if (status != WEFT_OK) return status;
  }
  return WEFT_OK;
}

void destroy(void* self) { delete static_cast<Still*>(self); }

constexpr weft_component component(const char* id, const char* needs, const char* reads,
                                   const char* produces, std::uint64_t methods,
                                   std::int32_t (*describe)(const weft_describe*, weft_error*)) {
  return {sizeof(weft_component),
          0,
          id,
          "1.0.0",
          "Answers as another one did.",
          "",
          "Apache-2.0",
          "exact",
          needs,
          reads,
          produces,
          methods,
          describe,
          &create,
          &prepare,
          &process,
          &destroy,
          nullptr};
}

constexpr std::array kComponents{
    component("sources/still", "", "", "image time", 0b111,
              [](const weft_describe* sink, weft_error*) {
                return declare(sink, "sources", "sources/test.scripted");
              }),
    component("detectors/still", "", "", "", 1,
              [](const weft_describe* sink, weft_error*) {
                return declare(sink, "detectors", "detectors/test.scripted");
              }),
    component("matchers/still", "keypoints template_keypoints", "", "", 1,
              [](const weft_describe* sink, weft_error*) {
                return declare(sink, "matchers", "matchers/test.scripted");
              }),
    component("filters/still", "", "previous.shape", "", 1,
              [](const weft_describe* sink, weft_error*) {
                return declare(sink, "filters", "filters/test.scripted");
              }),
    component("warps/still", "", "", "", 0b11,
              [](const weft_describe* sink, weft_error*) {
                return declare(sink, "warps", "warps/test.scripted");
              }),
    component("passes/still", "warp_samples", "", "sightlines visibility", 1,
              [](const weft_describe* sink, weft_error*) {
                return declare(sink, "passes", "passes/test.scripted");
              }),
    component("solvers/still", "sightlines", "correspondences previous.shape", "", 1,
              [](const weft_describe* sink, weft_error*) {
                return declare(sink, "solvers", "solvers/test.scripted");
              }),
    component("sinks/still", "", "shape correspondences visibility", "", 0b111,
              [](const weft_describe* sink, weft_error*) {
                return declare(sink, "sinks", "sinks/test.scripted");
              }),
};

constexpr std::array<const weft_component*, kComponents.size()> kPointers = [] {
  std::array<const weft_component*, kComponents.size()> pointers{};
  for (std::size_t i = 0; i < pointers.size(); ++i) pointers[i] = &kComponents[i];
  return pointers;
}();

}  // namespace

const weft_library_table weft_library = {WEFT_ABI_MAGIC,
                                         WEFT_ABI_MAJOR,
                                         WEFT_ABI_MINOR,
                                         sizeof(weft_library_table),
                                         kPointers.size(),
                                         WEFT_ABI_NAME,
                                         kPointers.data(),
                                         "",
                                         "by hand",
                                         0,
                                         0,
                                         0,
                                         {0, 0, 0, 0}};
