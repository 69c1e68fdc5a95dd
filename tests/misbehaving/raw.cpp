// SPDX-License-Identifier: Apache-2.0
// A filter written against the bare contract, which breaks it in one way after another.
#include <weft/abi.h>

#include <cstdint>
#include <cstring>
#include <iterator>
#include <string>
#include <string_view>

namespace {

constexpr const char* kMistakes[] = {
    "none",         "created_nothing", "no_output",    "no_reason",   "unknown_status",
    "unknown_code", "no_terminator",   "unknown_slot", "wrong_type",  "no_array_name",
    "no_shape",     "unknown_dtype",   "seven_axes",   "negative",    "too_large",
    "overflow",     "unknown_handle",  "null_log",     "wrong_dtype", "greedy",
    "huge_array",   "many_arrays"};

struct Raw {
  std::string_view mistake;
  std::int64_t frame;  // in which it makes it, -1 for all
};

std::int32_t describe(const weft_describe* sink, weft_error*) {
  weft_parameter parameter{};
  parameter.struct_size = sizeof(parameter);
  const char* fallback = "none";
  parameter.default_value = {"mistake", WEFT_VALUE_CHOICE, 0, 1, &fallback, {}};
  parameter.unit = parameter.role = parameter.was = "";
  parameter.help = "what it does wrong";
  parameter.choices = kMistakes;
  parameter.choice_count = std::size(kMistakes);
  sink->parameter(sink->context, &parameter);
  weft_parameter frame{};
  frame.struct_size = sizeof(frame);
  frame.integer_minimum = -1;
  frame.integer_maximum = 1'000'000;
  const std::int64_t all = -1;
  frame.default_value = {"frame", WEFT_VALUE_I64, 0, 1, &all, {}};
  frame.unit = frame.role = frame.was = "";
  frame.help = "in which it does, -1 for all";
  sink->parameter(sink->context, &frame);
  return WEFT_OK;
}

std::int32_t create(const weft_create* with, void** self, weft_error*) {
  std::string_view given = "none";
  std::int64_t frame = -1;
  for (std::uint64_t i = 0; i < with->count; ++i) {
    const weft_value& value = with->values[i];
    if (value.type == WEFT_VALUE_I64) {
      frame = *static_cast<const std::int64_t*>(value.data);
    } else {
      given = *static_cast<const char* const*>(value.data);
    }
  }
  if (given == "created_nothing") return WEFT_OK;
  for (const char* mistake : kMistakes) {
    if (given == mistake) *self = new Raw{mistake, frame};
  }
  return WEFT_OK;
}

std::int32_t prepare(void*, const weft_call*, const weft_record*, std::uint64_t, weft_error*) {
  return WEFT_OK;
}

std::int64_t count_matches(const weft_record* inputs, std::uint64_t count) {
  for (std::uint64_t i = 0; i < count; ++i) {
    if (std::string_view(inputs[i].slot) == "correspondences") return inputs[i].arrays[0].shape[0];
  }
  return 0;
}

/// Tries to allocate an array that the host must refuse; true when it did.
bool is_refused(std::string_view mistake, const weft_call* call) {
  const auto alloc = &weft_alloc;
  const std::int64_t length[] = {3, 3, 3, 3, 3, 3, 3};
  const std::int64_t negative[] = {-1};
  const std::int64_t large[] = {std::int64_t{1} << 42};
  const std::int64_t overflow[] = {0, std::int64_t{1} << 62, 8};
  const char* slot = "inlier_mask";
  const char* type = "inlier_mask/1";
  void* array = nullptr;
  if (mistake == "unknown_slot")
    array = alloc(call, "visibility", type, "kept", WEFT_U8, 1, length);
  if (mistake == "wrong_type") array = alloc(call, slot, "shape/1", "kept", WEFT_U8, 1, length);
  if (mistake == "no_array_name") array = alloc(call, slot, type, nullptr, WEFT_U8, 1, length);
  if (mistake == "no_shape") array = alloc(call, slot, type, "kept", WEFT_U8, 1, nullptr);
  if (mistake == "unknown_dtype") array = alloc(call, slot, type, "kept", 77, 1, length);
  if (mistake == "seven_axes") array = alloc(call, slot, type, "kept", WEFT_U8, 7, length);
  if (mistake == "negative") array = alloc(call, slot, type, "kept", WEFT_U8, 1, negative);
  if (mistake == "too_large") array = alloc(call, slot, type, "kept", WEFT_U8, 1, large);
  if (mistake == "huge_array") {
    const std::int64_t huge[] = {3, std::int64_t{1} << 27};
    array = alloc(call, slot, type, "x.test.huge", WEFT_F64, 2, huge);
  }
  for (int i = 0; mistake == "many_arrays" && i < 100'000; ++i) {
    const std::string name = "x.test.a" + std::to_string(i);
    array = alloc(call, slot, type, name.c_str(), WEFT_U8, 1, length);
    if (array == nullptr) break;
  }
  if (mistake == "overflow") array = alloc(call, slot, type, "diag.x", WEFT_F64, 3, overflow);
  return array == nullptr;
}

std::int32_t process(void* self, const weft_call* call, const weft_record* inputs,
                     std::uint64_t count, weft_error* error) {
  const Raw& raw = *static_cast<Raw*>(self);
  const bool due = raw.frame < 0 || call->frame == static_cast<std::uint64_t>(raw.frame);
  const std::string_view mistake = due ? raw.mistake : "none";
  if (mistake == "no_output") return WEFT_OK;
  if (mistake == "no_reason") return WEFT_ERROR;
  if (mistake == "unknown_status") return 77;
  if (mistake == "unknown_code") error->code = 12345;
  if (mistake == "unknown_code") return WEFT_ERROR;
  if (mistake == "no_terminator") {
    std::memset(error->message, 'x', sizeof(error->message));
    std::memset(error->where, 'y', sizeof(error->where));
    return WEFT_NO_RESULT;
  }
  if (mistake == "unknown_handle") {
    weft_invocation asked = {sizeof(asked), 0, 999, inputs, count, call->frame, 0, nullptr, 0};
    return call->host->invoke(call, &asked, error);
  }
  if (mistake == "null_log") call->host->log(call, 1, nullptr);
  if (!is_refused(mistake, call)) std::strcpy(error->message, "the host gave an illegal array");
  if (mistake == "many_arrays") std::strcpy(error->message, "has no room for its mask");
  if (error->message[0] != '\0') return WEFT_ERROR;
  const std::int64_t n = count_matches(inputs, count);
  if (mistake == "wrong_dtype" || mistake == "greedy") {
    const std::int32_t dtype = mistake == "greedy" ? WEFT_U8 : WEFT_F64;
    const std::int64_t length = mistake == "greedy" ? std::int64_t{1} << 40 : n;
    weft_alloc(call, "inlier_mask", "inlier_mask/1", "kept", dtype, 1, &length);
    weft_alloc(call, "inlier_mask", "inlier_mask/1", "score", WEFT_F64, 1, &n);
    return WEFT_OK;
  }
  auto* kept = static_cast<std::uint8_t*>(
      weft_alloc(call, "inlier_mask", "inlier_mask/1", "kept", WEFT_U8, 1, &n));
  auto* score = static_cast<double*>(
      weft_alloc(call, "inlier_mask", "inlier_mask/1", "score", WEFT_F64, 1, &n));
  for (std::int64_t i = 0; i < n; ++i) {
    kept[i] = 1;
    score[i] = 0.0;
  }
  return WEFT_OK;
}

void destroy(void* self) { delete static_cast<Raw*>(self); }

constexpr weft_component kComponent = {sizeof(weft_component),
                                       0,
                                       "filters/test_raw",
                                       "1.0.0",
                                       "Breaks the contract.",
                                       "",
                                       "",
                                       "exact",
                                       "",
                                       "",
                                       "",
                                       1,
                                       &describe,
                                       &create,
                                       &prepare,
                                       &process,
                                       &destroy,
                                       nullptr};
constexpr const weft_component* kPointer = &kComponent;

}  // namespace

const weft_library_table weft_library = {WEFT_ABI_MAGIC,
                                         WEFT_ABI_MAJOR,
                                         WEFT_ABI_MINOR,
                                         sizeof(weft_library_table),
                                         1,
                                         WEFT_ABI_NAME,
                                         &kPointer,
                                         "",
                                         "by hand",
                                         0,
                                         0,
                                         0,
                                         {0, 0, 0, 0}};
