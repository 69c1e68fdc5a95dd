// SPDX-License-Identifier: Apache-2.0
#include "host/describe/describe.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>
#include <weft/core/component_id.hpp>
#include <weft/core/quote.hpp>
#include <weft/sdk/extensions.hpp>

#include "host/describe/declaration_check.hpp"
#include "host/describe/manifest_text.hpp"
#include "host/describe/slots.hpp"
#include "host/guarding/library_call.hpp"

namespace weft::host {
namespace {

/// The range of a numeric parameter for a sweep.
struct Number {
  std::string name;
  double minimum, maximum;
};

/// Collects the declarations of one component, up to the first that is wrong.
struct Declarations {
  static constexpr std::size_t kMostParameters = 10'000;

  std::ostringstream text{};
  std::set<std::string> names{};
  std::vector<Number> numbers{};
  std::set<std::string> records{};
  std::map<std::string, std::map<std::string, std::string>> arrays{};  ///< by type and name
  std::string problem{};

  void add_field(const char* type, const weft_field* field) {
    if (!problem.empty()) return;
    if (type == nullptr || field == nullptr) problem = "an array of a record is null";
    if (problem.empty()) problem = wrong_field(*field);
    if (!problem.empty()) return;
    const std::string description = text_of(*field);
    const auto [known, is_new] = arrays[type].try_emplace(field->name, description);
    if (is_new || known->second == description) return;
    problem = "the array '" + std::string(field->name) + "' of " + type + " is declared twice";
  }

  void add(const weft_parameter* declared) {
    if (!problem.empty()) return;
    problem = declared != nullptr ? wrong_declaration(*declared) : "a parameter is null";
    if (!problem.empty()) return;
    const weft_parameter& parameter = *declared;
    const std::string name = parameter.default_value.name;
    if (!names.insert(name).second) problem = "parameter '" + name + "' is declared twice";
    if (names.size() > kMostParameters) {
      problem = "declares more than " + std::to_string(kMostParameters) + " parameters";
    }
    const weft_value& value = parameter.default_value;
    const bool is_number = value.type == WEFT_VALUE_F64 || value.type == WEFT_VALUE_I64;
    const bool is_integer = value.type == WEFT_VALUE_I64;
    if (is_number && value.is_vector == 0) {
      numbers.push_back(
          {name, is_integer ? static_cast<double>(parameter.integer_minimum) : parameter.minimum,
           is_integer ? static_cast<double>(parameter.integer_maximum) : parameter.maximum});
    }
    write_parameter(text, parameter);
  }

  void add_record(const char* type) {
    if (type == nullptr && problem.empty()) problem = "a type of records is null";
    if (type != nullptr) records.insert(type);
  }
};

struct Extension {
  const char* name;
  std::size_t bytes;  ///< size of its table, which begins with its size
};
constexpr Extension kExtensions[] = {{WEFT_DEVICE_MEMORY, kFirstSize<weft_device_memory>},
                                     {WEFT_DEVICES, kFirstSize<weft_devices>},
                                     {WEFT_CHECK, kFirstSize<weft_check>},
                                     {WEFT_SWEEP, kFirstSize<weft_sweep>},
                                     {WEFT_STEERING, kFirstSize<weft_steering>},
                                     {WEFT_ISOLATION, kFirstSize<weft_isolation>}};

/// The extensions beyond its role that this version of Weft supports.
std::string extensions(const weft_component& component) {
  std::string list;
  for (const Extension& extension : kExtensions) {
    const auto found = find_extension(component, extension.name, extension.bytes);
    if (found && *found != nullptr) list += (list.empty() ? "" : " ") + std::string(extension.name);
  }
  return words(list);
}

/// A reference without its first word, which specifies how the component follows it.
struct Reference {
  std::string_view implements;  ///< "paper", "reconstruction" or "own"; empty where none is given
  std::string_view text;
};

Reference reference_of(std::string_view text) {
  for (const std::string_view word : {"paper", "reconstruction", "own"}) {
    if (!text.starts_with(word) || text.substr(word.size(), 2) != ": ") continue;
    return {word, text.substr(word.size() + 2)};
  }
  return {{}, text};
}

/// The error of a component apart from its parameters, or an empty text.
std::string wrong_component(const weft_component& component, bool is_newer) {
  if (!is_component_id(component.id)) {
    return "its id '" + escaped(component.id) +
           "' is not of the form role/name or role/vendor.name";
  }
  for (const char* text : {component.version, component.summary, component.reference,
                           component.licence, component.determinism}) {
    if (!is_utf8(text)) return "one of its texts is no UTF-8";
  }
  for (const Extension& extension : kExtensions) {
    const auto found = find_extension(component, extension.name, extension.bytes);
    if (!found) return found.error().message;
  }
  return unknown_slots(component, is_newer);
}

const weft_sweep* sweep_of(const weft_component& component) {
  const auto found = extension_of<weft_sweep>(component, WEFT_SWEEP);
  return found ? *found : nullptr;
}

/// Writes the sweep of a component; returns what is wrong with it, or an empty text.
std::string write_sweep(std::ostream& out, const weft_sweep& sweep,
                        const std::vector<Number>& numbers) {
  if (sweep.parameter == nullptr || sweep.values == nullptr) return "its sweep is null";
  const std::string name = sweep.parameter;
  const auto number_of = std::find_if(numbers.begin(), numbers.end(),
                                      [&](const Number& each) { return each.name == name; });
  if (number_of == numbers.end()) return "its sweep names '" + name + "', which is no number of it";
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
  if (std::string wrong = wrong_component(component, is_newer); !wrong.empty()) return wrong;
  const Reference reference = reference_of(component.reference);
  out << "  - id: " << double_quoted(component.id)
      << "\n    version: " << double_quoted(component.version)
      << "\n    summary: " << double_quoted(component.summary)
      << "\n    reference: " << double_quoted(reference.text);
  if (!reference.implements.empty()) {
    out << "\n    implements: " << double_quoted(reference.implements);
  }
  out << "\n    licence: " << double_quoted(component.licence)
      << "\n    determinism: " << double_quoted(component.determinism)
      << "\n    needs: " << words(component.needs) << "\n    reads: " << words(component.reads)
      << "\n    produces: " << words(component.produces)
      << "\n    random: " << ((component.flags & WEFT_FLAG_RANDOM) != 0 ? "true" : "false")
      << "\n    uses_truth: " << ((component.flags & WEFT_FLAG_USES_TRUTH) != 0 ? "true" : "false")
      << "\n    extensions: " << extensions(component) << "\n    parameters:";
  Declarations declarations;
  const weft_describe sink{sizeof(weft_describe),
                           0,
                           &declarations,
                           [](void* context, const weft_parameter* parameter) {
                             static_cast<Declarations*>(context)->add(parameter);
                           },
                           [](void* context, const char* type) {
                             static_cast<Declarations*>(context)->add_record(type);
                           },
                           [](void* context, const char* type, const weft_field* field) {
                             static_cast<Declarations*>(context)->add_field(type, field);
                           }};
  weft_error error{sizeof(weft_error), 0, {}, {}, {}};
  const auto describe = [&] { return component.describe(&sink, &error); };
  const std::int32_t status = call_library(component.id, error, describe);
  if (status != WEFT_OK) {
    error.message[sizeof(error.message) - 1] = '\0';
    if (error.code == WEFT_CODE_INVALID_VALUE) return error.message;
    const std::string reason = error.message;
    return "its constructor failed while it declared its parameters (" +
           (reason.empty() ? "status " + std::to_string(status) : reason) +
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
  std::set<std::string> ids;
  for (std::uint32_t i = 0; i < library.count; ++i) {
    const weft_component& component = *library.components[i];
    std::string problem = write_component(out, component, library.sdk_minor > WEFT_ABI_MINOR);
    if (!ids.insert(component.id).second) problem = "is in the library twice";
    if (!problem.empty()) {
      return Error{Errc::plugin_failure, std::move(problem), component.id};
    }
  }
  return out.str();
}

}  // namespace weft::host
