// SPDX-License-Identifier: Apache-2.0
// How the component is described, and its extensions.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <utility>

#include "faults.hpp"

namespace weft::faults {
namespace {

/// The sink in front of the host's, which changes the first number and the first choice.
struct Between {
  const weft_describe& sink;
  bool has_number = false, has_choice = false;
};

void hand_on(const weft_describe& sink, const weft_parameter* parameter) {
  sink.parameter(sink.context, parameter);
}

void declare_choice(const weft_describe& sink, weft_parameter parameter) {
  static const char* const kChoices[] = {"red", "green", nullptr};
  static const char* const kBlue = "blue";
  if (has("no_choices")) parameter.choice_count = 0;
  if (has("no_choices") || has("null_choices")) parameter.choices = nullptr;
  if (has("null_choice")) parameter.choices = kChoices;
  if (has("null_choice")) parameter.choice_count = 3;
  if (has("foreign_choice")) parameter.default_value.data = &kBlue;
  if (has("null_default_text")) parameter.default_value.data = &kChoices[2];
  hand_on(sink, &parameter);
}

/// Another legal default.
template <class Number>
const void* other_default(const weft_parameter& parameter) {
  static Number other;
  const auto now = *static_cast<const Number*>(parameter.default_value.data);
  other = static_cast<double>(now) + 1.0 <= parameter.maximum ? now + Number{1} : now / Number{2};
  return &other;
}

void declare_number(const weft_describe& sink, weft_parameter parameter) {
  static double value = 2.0;
  weft_value& fallback = parameter.default_value;
  const bool is_real = fallback.type == WEFT_VALUE_F64;
  if (has("describes_other_default")) {
    fallback.data =
        is_real ? other_default<double>(parameter) : other_default<std::int64_t>(parameter);
  }
  if (has("nan_default")) value = std::nan("");
  if (has("nan_default") || has("outside_default")) fallback.data = &value;
  if (has("nan_range")) {
    parameter.minimum = std::nan("");
    parameter.integer_minimum = parameter.integer_maximum + 1;
  }
  if (has("null_name")) fallback.name = nullptr;
  if (has("null_help")) parameter.help = nullptr;
  if (has("null_unit")) parameter.unit = nullptr;
  if (has("null_default")) fallback.data = nullptr;
  if (has("no_default")) fallback.count = 0;
  if (has("latin_text")) parameter.help = "caf\xe9";
  if (has("control_text")) parameter.help = "a bell \a and a line\r\nand a \"tab\"\t";
  if (has("unknown_type")) fallback.type = 77;
  if (has("parameter_size_0")) parameter.struct_size = 0;
  if (has("parameter_larger")) parameter.struct_size += 64;
  hand_on(sink, has("null_parameter") ? nullptr : &parameter);
  if (has("parameter_twice")) hand_on(sink, &parameter);
  while (has("describe_endlessly_hangs")) {
    usleep(1000);
    hand_on(sink, &parameter);
  }
  const int more = has("many_parameters") ? 9000 : has("too_many_parameters") ? 12000 : 0;
  for (int i = 0; i < more; ++i) {
    const std::string name = "more_" + std::to_string(i);
    fallback.name = name.c_str();
    hand_on(sink, &parameter);
  }
}

void declare(void* context, const weft_parameter* given) {
  auto& between = *static_cast<Between*>(context);
  const weft_value& value = given->default_value;
  const bool is_number = value.is_vector == 0 && given->required == 0 &&
                         (value.type == WEFT_VALUE_F64 || value.type == WEFT_VALUE_I64);
  if (is_number && !std::exchange(between.has_number, true)) {
    return declare_number(between.sink, *given);
  }
  if (value.type == WEFT_VALUE_CHOICE && !std::exchange(between.has_choice, true)) {
    return declare_choice(between.sink, *given);
  }
  hand_on(between.sink, given);
}

void declare_record(void* context, const char* type) {
  const weft_describe& sink = static_cast<Between*>(context)->sink;
  sink.record(sink.context, has("null_record") ? nullptr : type);
}

void declare_field(void* context, const char* type, const weft_field* declared) {
  const weft_describe& sink = static_cast<Between*>(context)->sink;
  sink.field(sink.context, type, declared);
}

std::int32_t list_devices(void*, void (*device)(void* context, const char* text), weft_error*) {
  device(nullptr, "has no context");
  return WEFT_OK;
}

/// Another table each time.
const void* copied(const void* table) {
  static std::vector<std::vector<unsigned char>> copies;
  const auto* bytes = static_cast<const unsigned char*>(table);
  copies.emplace_back(bytes, bytes + *static_cast<const std::uint32_t*>(table));
  return copies.back().data();
}

}  // namespace

std::int32_t describe(const weft_describe* sink, weft_error* error) {
  if (has("describe_fails")) return refuse(*error, "no mood for it");
  if (has("describe_status")) return 77;
  if (has("describe_crashes")) write_where_nothing_is();
  if (has("describe_exits")) std::exit(0);
  if (has("describe_hangs")) sleep_for_ever();
  if (has("describe_throws")) throw 42;
  if (has("describing_opens_file")) close(open("/etc/hostname", O_RDONLY | O_CLOEXEC));
  Between between{*sink};
  const weft_describe mine{sizeof(weft_describe), 0, &between, declare, declare_record,
                           declare_field};
  return original().describe(&mine, error);
}

const void* get_extension(const weft_component* /*component*/, const char* name) {
  static constexpr std::string_view kKnown[] = {WEFT_DEVICE_MEMORY, WEFT_DEVICES,  WEFT_CHECK,
                                                WEFT_SWEEP,         WEFT_STEERING, WEFT_ISOLATION};
  alignas(8) static constexpr std::array<std::uint32_t, 16> kTable{64}, kEmpty{};
  static constexpr weft_devices kDevices{sizeof(weft_devices), 0, &list_devices};
  const std::string_view asked = name;
  if (has("extension_crashes")) write_where_nothing_is();
  const bool is_empty = (has("empty_check") && asked == WEFT_CHECK) ||
                        (has("empty_sweep") && asked == WEFT_SWEEP) ||
                        (has("empty_memory") && asked == WEFT_DEVICE_MEMORY) ||
                        (has("empty_devices") && asked == WEFT_DEVICES);
  if (is_empty) return kEmpty.data();
  if (has("devices_crash") && asked == WEFT_DEVICES) return &kDevices;
  const void* own =
      original().get_extension != nullptr ? original().get_extension(&original(), name) : nullptr;
  if (has("extension_moves") && own != nullptr) return copied(own);
  const bool is_known = std::find(std::begin(kKnown), std::end(kKnown), asked) != std::end(kKnown);
  return has("answers_unknown_extension") && own == nullptr && !is_known ? kTable.data() : own;
}

}  // namespace weft::faults
