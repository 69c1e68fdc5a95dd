// SPDX-License-Identifier: Apache-2.0
// What the animal says of its parameters and abilities.
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>

#include "animal.hpp"

namespace zoo {
namespace {

weft_parameter number(const char* name, const double* value) {
  weft_parameter parameter{};
  parameter.struct_size = sizeof(parameter);
  parameter.default_value = {name, WEFT_VALUE_F64, 0, 1, value, {}};
  parameter.unit = parameter.role = parameter.was = "";
  parameter.help = "how strict it is";
  parameter.minimum = 0.0;
  parameter.maximum = 1.0;
  return parameter;
}

weft_parameter choice(const char* const* value, const char* const* choices, std::uint64_t count) {
  weft_parameter parameter = number("colour", nullptr);
  parameter.minimum = -std::numeric_limits<double>::infinity();
  parameter.maximum = std::numeric_limits<double>::infinity();
  parameter.default_value.type = WEFT_VALUE_CHOICE;
  parameter.default_value.data = value;
  parameter.choices = choices;
  parameter.choice_count = count;
  return parameter;
}

void declare_choice(const weft_describe* sink) {
  static const char* const kChoices[] = {"red", "green", nullptr};
  static const char* const kBlue = "blue";
  weft_parameter parameter = choice(kChoices, kChoices, 2);
  if (is("no_choices")) parameter.choice_count = 0;
  if (is("no_choices")) parameter.choices = nullptr;
  if (is("null_choices")) parameter.choices = nullptr;
  if (is("null_choice")) parameter.choice_count = 3;
  if (is("foreign_choice")) parameter.default_value.data = &kBlue;
  if (is("null_default_text")) parameter.default_value.data = &kChoices[2];
  sink->parameter(sink->context, &parameter);
}

void declare_number(const weft_describe* sink) {
  static double value = 0.5;
  weft_parameter parameter = number("strictness", &value);
  if (is("nan_default")) value = std::nan("");
  if (is("outside_default")) value = 2.0;
  if (is("nan_range")) parameter.minimum = std::nan("");
  if (is("null_name")) parameter.default_value.name = nullptr;
  if (is("null_help")) parameter.help = nullptr;
  if (is("null_unit")) parameter.unit = nullptr;
  if (is("null_default")) parameter.default_value.data = nullptr;
  if (is("no_default")) parameter.default_value.count = 0;
  if (is("latin_text")) parameter.help = "caf\xe9";
  if (is("control_text")) parameter.help = "a bell \a and a line\r\nand a \"tab\"\t";
  if (is("unknown_type")) parameter.default_value.type = 77;
  if (is("parameter_size_0")) parameter.struct_size = 0;
  if (is("parameter_larger")) parameter.struct_size += 64;
  sink->parameter(sink->context, is("null_parameter") ? nullptr : &parameter);
  if (is("describe_endlessly_hangs")) usleep(1000);
  if (is("parameter_twice")) sink->parameter(sink->context, &parameter);
}

void declare_many(const weft_describe* sink, int count) {
  static const double kValue = 0.5;
  for (int i = 0; i < count; ++i) {
    const std::string name = "strictness_" + std::to_string(i);
    const weft_parameter parameter = number(name.c_str(), &kValue);
    sink->parameter(sink->context, &parameter);
  }
}

std::int32_t list_devices(void*, void (*device)(void* context, const char* text), weft_error*) {
  device(nullptr, "never asked for");
  return WEFT_OK;
}

}  // namespace

std::int32_t describe(const weft_describe* sink, weft_error* error) {
  if (is("describe_fails")) std::strcpy(error->message, "no mood for it");
  if (is("describe_fails")) return WEFT_ERROR;
  if (is("describe_status")) return 77;
  if (is("describe_crashes")) write_where_nothing_is();
  if (is("describe_exits")) std::exit(0);
  if (is("describe_hangs")) sleep_for_ever();
  if (is("describe_throws")) throw 42;
  if (is("many_parameters")) declare_many(sink, 9000);
  if (is("too_many_parameters")) declare_many(sink, 12000);
  while (is("describe_endlessly_hangs")) declare_number(sink);
  declare_number(sink);
  declare_choice(sink);
  sink->record(sink->context, is("null_record") ? nullptr : "correspondences/1");
  return WEFT_OK;
}

const void* get_extension(const char* name) {
  static constexpr weft_check kNoCheck{};
  static constexpr weft_devices kNoDevices{};
  static constexpr weft_devices kDevices{sizeof(weft_devices), 0, &list_devices};
  static constexpr weft_sweep kNoSweep{};
  static constexpr weft_device_memory kNoMemory{};
  const std::string_view asked = name;
  if (is("extension_crashes")) write_where_nothing_is();
  if (is("empty_check") && asked == WEFT_CHECK) return &kNoCheck;
  if (is("empty_sweep") && asked == WEFT_SWEEP) return &kNoSweep;
  if (is("empty_memory") && asked == WEFT_DEVICE_MEMORY) return &kNoMemory;
  if (is("empty_devices") && asked == WEFT_DEVICES) return &kNoDevices;
  if (asked != WEFT_DEVICES || !is("devices_crash")) return nullptr;
  return &kDevices;
}

}  // namespace zoo
