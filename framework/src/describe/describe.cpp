// SPDX-License-Identifier: Apache-2.0
#include "describe/describe.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

#include "describe/slots.hpp"

namespace weft::host {
namespace {

/// A double-quoted YAML scalar.
std::string double_quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (c == '\n') {
      result += "\\n";
    } else {
      result += c;
    }
  }
  return result + '"';
}

std::string number(double value) {
  if (std::isinf(value)) return value > 0 ? ".inf" : "-.inf";
  std::array<char, 40> buffer;
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end};
}

const char* type_name(std::int32_t type) {
  constexpr const char* kNames[] = {"",     "f64",        "i64",         "bool",      "choice",
                                    "text", "input_path", "output_path", "component", "labels"};
  return type >= 1 && type <= 9 ? kNames[type] : "unknown";
}

std::string element(const weft_value& value, std::uint64_t index) {
  switch (value.type) {
    case WEFT_VALUE_F64:
      return number(static_cast<const double*>(value.data)[index]);
    case WEFT_VALUE_I64:
      return std::to_string(static_cast<const std::int64_t*>(value.data)[index]);
    case WEFT_VALUE_BOOL:
      return static_cast<const std::uint8_t*>(value.data)[index] != 0 ? "true" : "false";
    default:
      return double_quoted(static_cast<const char* const*>(value.data)[index]);
  }
}

std::string default_of(const weft_value& value) {
  if (value.type == WEFT_VALUE_LABELS) return "{}";
  if (value.is_vector == 0) return element(value, 0);
  std::string list = "[";
  for (std::uint64_t i = 0; i < value.count; ++i) {
    list += (i > 0 ? ", " : "") + element(value, i);
  }
  return list + "]";
}

bool is_bounded(const weft_parameter& parameter) {
  const bool is_number = parameter.default_value.type == WEFT_VALUE_F64 ||
                         parameter.default_value.type == WEFT_VALUE_I64;
  return is_number && (std::isfinite(parameter.minimum) || std::isfinite(parameter.maximum));
}

void write_parameter(std::ostream& out, const weft_parameter& parameter) {
  const weft_value& value = parameter.default_value;
  out << "      - name: " << double_quoted(value.name)
      << "\n        type: " << type_name(value.type);
  if (value.is_vector != 0) out << "\n        vector: true";
  if (parameter.required != 0) {
    out << "\n        required: true";
  } else {
    out << "\n        default: " << default_of(value);
  }
  if (*parameter.unit != '\0') out << "\n        unit: " << double_quoted(parameter.unit);
  if (is_bounded(parameter)) {
    out << "\n        range: [" << number(parameter.minimum) << ", " << number(parameter.maximum)
        << "]";
  }
  for (std::uint64_t i = 0; i < parameter.choice_count; ++i) {
    out << (i == 0 ? "\n        choices: [" : ", ") << double_quoted(parameter.choices[i]);
  }
  if (parameter.choice_count > 0) out << "]";
  if (*parameter.role != '\0') out << "\n        role: " << double_quoted(parameter.role);
  if (*parameter.was != '\0') out << "\n        was: " << double_quoted(parameter.was);
  out << "\n        help: " << double_quoted(parameter.help) << "\n";
}

bool is_outside(double number, const weft_parameter& parameter) {
  return !std::isfinite(number) || number < parameter.minimum || number > parameter.maximum;
}

/// Why no pipeline could ever use a parameter as it is declared, or empty.
std::string contradiction(const weft_parameter& parameter) {
  const weft_value& value = parameter.default_value;
  if (!(parameter.minimum <= parameter.maximum))
    return "has a range whose minimum is the larger end";
  if (parameter.required != 0) return {};
  bool outside = false;
  for (std::uint64_t i = 0; i < value.count; ++i) {
    if (value.type == WEFT_VALUE_F64) {
      outside = outside || is_outside(static_cast<const double*>(value.data)[i], parameter);
    } else if (value.type == WEFT_VALUE_I64) {
      const std::int64_t number = static_cast<const std::int64_t*>(value.data)[i];
      outside = outside || is_outside(static_cast<double>(number), parameter);
    }
  }
  if (outside) return "has a default outside its range";
  if (value.type != WEFT_VALUE_CHOICE) return {};
  const bool listed = *static_cast<const char* const*>(value.data)[0] != '\0';
  return listed ? "" : "has a default that is none of its choices";
}

const char* dtype_word(std::int32_t dtype) {
  constexpr const char* kNames[] = {"", "u8", "i8", "u16", "i16", "i32", "i64", "f32", "f64"};
  return dtype >= WEFT_U8 && dtype <= WEFT_F64 ? kNames[dtype] : "unknown";
}

std::string text_of(const weft_field& field) {
  const auto flag = [&](std::uint32_t bit) { return (field.flags & bit) != 0 ? "true" : "false"; };
  return "{name: " + double_quoted(field.name) + ", type: " + dtype_word(field.dtype) +
         ", shape: " + double_quoted(field.shape) + ", unit: " + double_quoted(field.unit) +
         ", meaning: " + double_quoted(field.meaning) + ", optional: " + flag(WEFT_FIELD_OPTIONAL) +
         ", may_be_nan: " + flag(WEFT_FIELD_MAY_BE_NAN) + "}";
}

/// What a sweep may take of a parameter that is one number.
struct Number {
  std::string name;
  double minimum, maximum;
};

/// Collects the declarations of one component.
struct Declarations {
  std::ostringstream text{};
  std::vector<std::string> names{};
  std::vector<Number> numbers{};
  std::set<std::string> records{};
  std::map<std::string, std::map<std::string, std::string>> arrays{};  ///< by type and name
  std::string problem{};                                               ///< the first one

  void add(const std::string& type, const weft_field& field) {
    const std::string told = text_of(field);
    const auto [known, is_new] = arrays[type].try_emplace(field.name, told);
    if (!is_new && known->second != told && problem.empty()) {
      problem = "the array '" + std::string(field.name) + "' of " + type + " is declared twice";
    }
  }

  void add(const weft_parameter& parameter) {
    const std::string name = parameter.default_value.name;
    std::string wrong = contradiction(parameter);
    if (std::find(names.begin(), names.end(), name) != names.end()) wrong = "is declared twice";
    if (!wrong.empty() && problem.empty()) problem = "parameter '" + name + "' " + wrong;
    names.push_back(name);
    const weft_value& value = parameter.default_value;
    const bool is_number = value.type == WEFT_VALUE_F64 || value.type == WEFT_VALUE_I64;
    if (is_number && value.is_vector == 0) {
      numbers.push_back({name, parameter.minimum, parameter.maximum});
    }
    write_parameter(text, parameter);
  }
};

std::string words(std::string_view text) {
  std::string list = "[";
  std::istringstream stream{std::string(text)};
  for (std::string word; stream >> word;)
    list += (list.size() > 1 ? ", " : "") + double_quoted(word);
  return list + "]";
}

/// Those abilities beyond its role that this version of Weft knows of.
std::string extensions(const weft_component& component) {
  std::string list;
  for (const char* name :
       {WEFT_DEVICE_MEMORY, WEFT_DEVICES, WEFT_CHECK, WEFT_SWEEP, WEFT_STEERING, WEFT_ISOLATION}) {
    const bool has = component.get_extension != nullptr && component.get_extension(name) != nullptr;
    if (has) list += (list.empty() ? "" : " ") + std::string(name);
  }
  return words(list);
}

const weft_sweep* sweep_of(const weft_component& component) {
  if (component.get_extension == nullptr) return nullptr;
  return static_cast<const weft_sweep*>(component.get_extension(WEFT_SWEEP));
}

/// Writes the sweep of a component; returns what is wrong with it, or an empty text.
std::string write_sweep(std::ostream& out, const weft_sweep& sweep,
                        const std::vector<Number>& numbers) {
  const std::string name = sweep.parameter;
  const auto number_of = std::find_if(numbers.begin(), numbers.end(),
                                      [&](const Number& each) { return each.name == name; });
  if (number_of == numbers.end()) return "its sweep is of '" + name + "', which is no number of it";
  const double* end = sweep.values + sweep.count;
  const bool rising = std::adjacent_find(sweep.values, end, std::greater_equal<>()) == end;
  const bool legal = sweep.count >= 2 && rising && sweep.values[0] >= number_of->minimum &&
                     end[-1] <= number_of->maximum;
  if (!legal) {
    return "its sweep of '" + name + "' is not at least two ascending values in its range";
  }
  out << "    sweep:\n      parameter: " << double_quoted(name) << "\n      values: [";
  for (const double* value = sweep.values; value != end; ++value) {
    out << (value == sweep.values ? "" : ", ") << number(*value);
  }
  out << "]\n";
  return {};
}

/// Returns what is wrong with the declarations, or an empty text.
std::string write_component(std::ostream& out, const weft_component& component, bool is_newer) {
  out << "  - id: " << double_quoted(component.id)
      << "\n    version: " << double_quoted(component.version)
      << "\n    summary: " << double_quoted(component.summary)
      << "\n    reference: " << double_quoted(component.reference)
      << "\n    licence: " << double_quoted(component.licence)
      << "\n    determinism: " << double_quoted(component.determinism)
      << "\n    needs: " << words(component.needs) << "\n    reads: " << words(component.reads)
      << "\n    produces: " << words(component.produces)
      << "\n    random: " << ((component.flags & WEFT_FLAG_RANDOM) != 0 ? "true" : "false")
      << "\n    uses_truth: " << ((component.flags & WEFT_FLAG_USES_TRUTH) != 0 ? "true" : "false")
      << "\n    extensions: " << extensions(component) << "\n    parameters:";
  if (std::string unknown = unknown_slots(component, is_newer); !unknown.empty()) return unknown;
  Declarations declarations;
  const weft_describe sink{sizeof(weft_describe),
                           0,
                           &declarations,
                           [](void* context, const weft_parameter* parameter) {
                             static_cast<Declarations*>(context)->add(*parameter);
                           },
                           [](void* context, const char* type) {
                             static_cast<Declarations*>(context)->records.insert(type);
                           },
                           [](void* context, const char* type, const weft_field* field) {
                             static_cast<Declarations*>(context)->add(type, *field);
                           }};
  weft_error error{sizeof(weft_error), 0, {}, {}, {}};
  if (component.describe(&sink, &error) != WEFT_OK) {
    error.message[sizeof(error.message) - 1] = '\0';
    if (error.code == WEFT_CODE_INVALID_VALUE) return error.message;
    return "its constructor failed while it declared its parameters (" +
           std::string(error.message) +
           "); it should read them all and do nothing else: files and checks belong in prepare()";
  }
  const std::string text = declarations.text.str();
  out << (text.empty() ? " []\n" : "\n" + text);
  std::string records;
  for (const std::string& type : declarations.records) records += type + " ";
  out << "    records: " << words(records) << "\n";
  if (std::string wrong = wrong_open_slots(component, declarations.records); !wrong.empty()) {
    return wrong;
  }
  if (!declarations.arrays.empty()) out << "    record_types:\n";
  for (const auto& [type, arrays] : declarations.arrays) {
    out << "      - record: " << double_quoted(type) << "\n        arrays:\n";
    for (const auto& [name, declared] : arrays) out << "          - " << declared << "\n";
  }
  const weft_sweep* sweep = sweep_of(component);
  if (sweep == nullptr || !declarations.problem.empty()) return declarations.problem;
  return write_sweep(out, *sweep, declarations.numbers);
}

}  // namespace

Result<std::string> describe_library(const weft_library_table& library,
                                     const std::string& build_id) {
  std::ostringstream out;
  out << "# Written by the build; bound to the library by its build-id.\n"
      << "weft_plugin: 1\nabi: [" << library.abi_major << ", " << library.sdk_minor
      << "]\nneeds_minor: " << library.needs_minor << "\n"
      << "build_id: " << double_quoted(build_id)
      << "\ncompiler: " << double_quoted(library.compiler) << "\nisa: " << words(library.isa)
      << "\ncomponents:\n";
  for (std::uint32_t i = 0; i < library.count; ++i) {
    const weft_component& component = *library.components[i];
    if (std::string problem = write_component(out, component, library.sdk_minor > WEFT_ABI_MINOR);
        !problem.empty()) {
      return Error{Errc::plugin_failure, std::move(problem), component.id};
    }
  }
  return out.str();
}

}  // namespace weft::host
