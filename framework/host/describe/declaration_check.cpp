// SPDX-License-Identifier: Apache-2.0
#include "host/describe/declaration_check.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <weft/core/utf8.hpp>
#include <weft/data/array.hpp>

#include "host/guarding/first_sizes.hpp"

namespace weft::host {
namespace {

bool is_outside(double number, const weft_parameter& parameter) {
  return number < parameter.minimum || number > parameter.maximum;
}

bool is_outside(std::int64_t number, const weft_parameter& parameter) {
  return number < parameter.integer_minimum || number > parameter.integer_maximum;
}

bool has_empty_range(const weft_parameter& parameter) {
  if (parameter.default_value.type == WEFT_VALUE_I64) {
    return parameter.integer_minimum > parameter.integer_maximum;
  }
  return parameter.default_value.type == WEFT_VALUE_F64 &&
         !(parameter.minimum <= parameter.maximum);
}

bool is_text(std::int32_t type) {
  return type == WEFT_VALUE_CHOICE || type == WEFT_VALUE_TEXT || type == WEFT_VALUE_INPUT_PATH ||
         type == WEFT_VALUE_OUTPUT_PATH || type == WEFT_VALUE_COMPONENT;
}

std::string wrong_texts(const weft_parameter& parameter) {
  const char* const all[] = {parameter.unit, parameter.help, parameter.role, parameter.was};
  const auto is_null = [](const char* text) { return text == nullptr; };
  if (std::any_of(std::begin(all), std::end(all), is_null)) {
    return "has a unit, help, role or was that is null: give \"\" where there is none";
  }
  if (parameter.choice_count > 0 &&
      (parameter.choices == nullptr ||
       std::any_of(parameter.choices, parameter.choices + parameter.choice_count, is_null))) {
    return "has choices that are null";
  }
  const bool legible =
      std::all_of(std::begin(all), std::end(all), is_utf8) &&
      std::all_of(parameter.choices, parameter.choices + parameter.choice_count, is_utf8);
  return legible ? "" : "has a text that is no UTF-8";
}

std::string wrong_default_text(const weft_parameter& parameter) {
  const weft_value& value = parameter.default_value;
  const auto* texts = static_cast<const char* const*>(value.data);
  for (std::uint64_t i = 0; i < value.count; ++i) {
    if (texts[i] == nullptr) return "has a default that is null";
    if (!is_utf8(texts[i])) return "has a default that is no UTF-8";
    const auto is_it = [&](const char* choice) { return std::string_view(choice) == texts[i]; };
    if (value.type == WEFT_VALUE_CHOICE &&
        std::none_of(parameter.choices, parameter.choices + parameter.choice_count, is_it)) {
      return "has a default that is none of its choices";
    }
  }
  return {};
}

std::string wrong_default(const weft_parameter& parameter) {
  const weft_value& value = parameter.default_value;
  if (value.type == WEFT_VALUE_LABELS) return {};
  if (value.is_vector == 0 && value.count == 0) return "has no default and is not required";
  if (value.count > 0 && value.data == nullptr) return "has a default that is null";
  if (is_text(value.type)) return wrong_default_text(parameter);
  bool outside = false;
  for (std::uint64_t i = 0; i < value.count; ++i) {
    if (value.type == WEFT_VALUE_F64) {
      const double number = static_cast<const double*>(value.data)[i];
      if (!std::isfinite(number)) return "has a default that is not finite";
      outside = outside || is_outside(number, parameter);
    } else if (value.type == WEFT_VALUE_I64) {
      outside = outside || is_outside(static_cast<const std::int64_t*>(value.data)[i], parameter);
    }
  }
  return outside ? "has a default outside its range" : "";
}

}  // namespace

bool is_utf8(std::string_view text) {
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t bytes = utf8::decode(text, at).bytes;
    if (bytes == 0) return false;
    at += bytes;
  }
  return true;
}

const char* type_name(std::int32_t type) {
  constexpr const char* kNames[] = {"f64",        "i64",         "bool",      "choice", "text",
                                    "input_path", "output_path", "component", "labels"};
  return type >= 1 && type <= 9 ? kNames[type - 1] : nullptr;
}

std::string wrong_declaration(const weft_parameter& parameter) {
  if (parameter.struct_size < kFirstSize<weft_parameter>) {
    return "a parameter is declared with a struct_size that is too small";
  }
  if ((parameter.flags & kMustBeKnown) != 0) {
    return "a parameter requires a feature that this version of Weft lacks";
  }
  const char* name = parameter.default_value.name;
  if (name == nullptr || *name == '\0') return "a parameter has no name";
  if (!is_utf8(name)) return "a parameter has a name that is no UTF-8";
  std::string wrong = wrong_texts(parameter);
  if (wrong.empty() && has_empty_range(parameter)) {
    wrong = "has a range whose minimum is the larger end";
  }
  const bool is_known = type_name(parameter.default_value.type) != nullptr;
  if (wrong.empty() && is_known && parameter.required == 0) wrong = wrong_default(parameter);
  return wrong.empty() ? "" : "parameter '" + std::string(name) + "' " + wrong;
}

std::string wrong_field(const weft_field& field) {
  if (field.struct_size < kFirstSize<weft_field>) {
    return "an array of a record is declared with a struct_size that is too small";
  }
  if ((field.flags & kMustBeKnown) != 0) {
    return "an array of a record requires a feature that this version of Weft lacks";
  }
  for (const char* text : {field.name, field.shape, field.unit, field.meaning}) {
    if (text == nullptr)
      return "an array of a record has a name, shape, unit or meaning that is null";
    if (!is_utf8(text)) return "an array of a record has a text that is no UTF-8";
  }
  return dtype_size(field.dtype) > 0
             ? ""
             : "array '" + std::string(field.name) + "' has elements of an unknown type";
}

}  // namespace weft::host
