// SPDX-License-Identifier: Apache-2.0
#include "host/loading/manifest.hpp"

#include <array>
#include <utility>
#include <weft/core/component_id.hpp>

#include "host/roles/open_slots.hpp"

namespace weft::host {
namespace {

constexpr std::array<std::pair<const char*, weft_value_type>, 9> kTypes{{
    {"f64", WEFT_VALUE_F64},
    {"i64", WEFT_VALUE_I64},
    {"bool", WEFT_VALUE_BOOL},
    {"choice", WEFT_VALUE_CHOICE},
    {"text", WEFT_VALUE_TEXT},
    {"input_path", WEFT_VALUE_INPUT_PATH},
    {"output_path", WEFT_VALUE_OUTPUT_PATH},
    {"component", WEFT_VALUE_COMPONENT},
    {"labels", WEFT_VALUE_LABELS},
}};

/// Thrown inside this file only, when a manifest lacks something.
struct Missing {
  yaml::Position at;
  std::string what;
};

/// Likewise, when a component has a parameter of a later version.
struct UnknownType {
  std::string what;
};

const yaml::Node& get(const yaml::Node& node, const char* key) {
  const yaml::Node* value = node.find(key);
  if (value == nullptr) throw Missing{node.at, std::string("'") + key + "' is missing"};
  return *value;
}

std::string text(const yaml::Node& node, const char* key) {
  const yaml::Node& value = get(node, key);
  if (value.kind != yaml::Kind::scalar) throw Missing{value.at, std::string(key) + " is no text"};
  return value.scalar;
}

const std::vector<yaml::Node>& items(const yaml::Node& node, const char* key) {
  const yaml::Node& value = get(node, key);
  if (value.kind != yaml::Kind::sequence) {
    throw Missing{value.at, std::string("'") + key + "' is no list"};
  }
  return value.items;
}

std::vector<std::string> texts(const yaml::Node& node, const char* key) {
  std::vector<std::string> result;
  for (const yaml::Node& item : items(node, key)) result.push_back(item.scalar);
  return result;
}

bool flag(const yaml::Node& node, const char* key) {
  const yaml::Node* value = node.find(key);
  return value != nullptr && yaml::as_bool(*value).value_or(false);
}

/// Lists of others may come with a later version.
bool may_be_list(weft_value_type type) {
  return type == WEFT_VALUE_F64 || type == WEFT_VALUE_I64 || type == WEFT_VALUE_TEXT;
}

ParameterSpec read_parameter(const yaml::Node& node) {
  ParameterSpec spec;
  spec.name = text(node, "name");
  const std::string type = text(node, "type");
  bool known = false;
  for (const auto& [word, value] : kTypes) {
    if (type != word) continue;
    spec.type = value;
    known = true;
  }
  if (!known)
    throw UnknownType{"parameter '" + spec.name + "' has the unknown type '" + type + "'"};
  spec.is_vector = flag(node, "vector");
  if (spec.is_vector && !may_be_list(spec.type))
    throw UnknownType{"parameter '" + spec.name + "' is a list of the type '" + type + "'"};
  spec.required = flag(node, "required");
  if (!spec.required) spec.default_value = get(node, "default");
  if (node.find("unit") != nullptr) spec.unit = text(node, "unit");
  spec.help = text(node, "help");
  if (const yaml::Node* range = node.find("range")) {
    const bool two = range->items.size() == 2;
    const auto minimum = two ? yaml::as_double(range->items[0]) : std::nullopt;
    const auto maximum = two ? yaml::as_double(range->items[1]) : std::nullopt;
    if (!minimum || !maximum || !(*minimum <= *maximum)) {
      throw Missing{range->at, "'range' is not [minimum, maximum]"};
    }
    spec.bounded = true;
    spec.minimum = *minimum;
    spec.maximum = *maximum;
    spec.integer_minimum = yaml::as_int64(range->items[0]).value_or(spec.integer_minimum);
    spec.integer_maximum = yaml::as_int64(range->items[1]).value_or(spec.integer_maximum);
  }
  if (node.find("choices") != nullptr) spec.choices = texts(node, "choices");
  if (node.find("role") != nullptr) spec.role = text(node, "role");
  if (node.find("was") != nullptr) spec.was = text(node, "was");
  spec.is_deprecated = flag(node, "deprecated");
  spec.is_prominent = flag(node, "prominent");
  return spec;
}

SweepSpec read_sweep(const yaml::Node& node) {
  SweepSpec sweep{text(node, "parameter"), {}};
  for (const yaml::Node& item : items(node, "values")) {
    const auto value = yaml::as_double(item);
    if (!value) throw Missing{item.at, "a value of 'sweep' is no number"};
    sweep.values.push_back(*value);
  }
  return sweep;
}

RecordSchema read_record_type(const yaml::Node& node) {
  RecordSchema schema{text(node, "record"), {}};
  if (!is_vendor_record(schema.type)) {
    throw Missing{node.at, "'" + schema.type + "' is not of the form vendor.name/version"};
  }
  for (const yaml::Node& array : items(node, "arrays")) {
    const std::string type = text(array, "type");
    const std::int32_t dtype = dtype_called(type);
    if (dtype == 0) throw Missing{array.at, "'" + type + "' is no type of elements"};
    schema.arrays.push_back({text(array, "name"), text(array, "shape"), text(array, "unit"),
                             text(array, "meaning"), dtype, flag(array, "optional"),
                             flag(array, "may_be_nan")});
  }
  return schema;
}

ComponentManifest read_component(const yaml::Node& node) {
  ComponentManifest component;
  component.id = text(node, "id");
  component.version = text(node, "version");
  component.summary = text(node, "summary");
  component.reference = text(node, "reference");
  if (node.find("implements") != nullptr) component.implements = text(node, "implements");
  component.licence = text(node, "licence");
  component.determinism = text(node, "determinism");
  component.needs = texts(node, "needs");
  component.reads = texts(node, "reads");
  component.produces = texts(node, "produces");
  component.random = flag(node, "random");
  component.uses_truth = flag(node, "uses_truth");
  if (node.find("extensions") != nullptr) component.extensions = texts(node, "extensions");
  if (node.find("records") != nullptr) component.records = texts(node, "records");
  if (node.find("record_types") != nullptr) {
    for (const yaml::Node& type : items(node, "record_types")) {
      component.record_types.push_back(read_record_type(type));
    }
  }
  try {
    for (const yaml::Node& parameter : items(node, "parameters")) {
      component.parameters.push_back(read_parameter(parameter));
    }
  } catch (const UnknownType& unknown) {
    component.unknown =
        "'" + component.id + "' cannot be used by this version of Weft: its " + unknown.what;
  }
  if (const yaml::Node* sweep = node.find("sweep")) component.sweep = read_sweep(*sweep);
  component.find_rules();
  return component;
}

Manifest read_root(const yaml::Node& root) {
  Manifest manifest;
  if (text(root, "weft_plugin") != "1") throw Missing{root.at, "has another manifest version"};
  const yaml::Node& abi = get(root, "abi");
  if (abi.items.size() != 2) throw Missing{abi.at, "'abi' is not [major, minor]"};
  const auto version = [](const yaml::Node& part) {
    const std::int64_t number = yaml::as_int64(part).value_or(-1);
    return number >= 0 && number <= 0xFFFF ? static_cast<int>(number) : -1;
  };
  manifest.abi_major = version(abi.items[0]);
  manifest.abi_minor = version(abi.items[1]);
  if (const yaml::Node* needs = root.find("needs_minor")) manifest.needs_minor = version(*needs);
  manifest.build_id = text(root, "build_id");
  manifest.compiler = text(root, "compiler");
  manifest.isa = texts(root, "isa");
  for (const yaml::Node& component : items(root, "components")) {
    manifest.components.push_back(read_component(component));
  }
  if (manifest.components.empty()) throw Missing{root.at, "'components' is empty"};
  return manifest;
}

}  // namespace

const RecordSchema* ComponentManifest::schema_of(std::string_view type) const {
  const auto found = std::find_if(record_types.begin(), record_types.end(),
                                  [&](const RecordSchema& each) { return each.type == type; });
  return found != record_types.end() ? &*found : nullptr;
}

void ComponentManifest::find_rules() {
  const RoleRules& of_role = rules_of(role());
  if (!of_role.is_open) return;
  auto own = rules_with(of_role, {needs, reads, produces, records});
  if (own) {
    open_rules = std::make_shared<const RoleRules>(*std::move(own));
  } else if (unknown.empty()) {
    unknown = "'" + id + "' cannot be used by this version of Weft: it " + own.error().message;
  }
}

Result<Manifest> read_manifest(const std::string& file) {
  const auto text = yaml::read_text(file);
  if (!text) return text.error();
  const auto document = yaml::parse(*text, file);
  if (!document) return document.error();
  if (!document->problems.empty()) {
    const yaml::Problem& first = document->problems.front();
    return Error{Errc::syntax, first.message, yaml::place(file, first.at)};
  }
  try {
    Manifest manifest = read_root(document->root);
    manifest.file = file;
    manifest.library = file.substr(0, file.rfind(".plugin.yaml")) + ".so";
    return manifest;
  } catch (const Missing& missing) {
    return Error{Errc::invalid_data, missing.what, yaml::place(file, missing.at)};
  }
}

const char* parameter_type_name(weft_value_type type) {
  for (const auto& [word, value] : kTypes) {
    if (type == value) return word;
  }
  return "unknown";
}

}  // namespace weft::host
