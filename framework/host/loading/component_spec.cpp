// SPDX-License-Identifier: Apache-2.0
#include "host/loading/component_spec.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <weft/core/file_order.hpp>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/suggest.hpp>

#include "host/loading/component_keys.hpp"
#include "host/loading/secrets.hpp"
#include "yaml/keys.hpp"

namespace weft::host {
namespace {

namespace fs = std::filesystem;

ComponentSpec resolve(const Registry& registry, const yaml::Node& use, const yaml::Node* params,
                      const PathRules& paths, std::vector<yaml::Problem>& problems,
                      std::vector<std::string> parents);

/// Binds the parameters of one component.
class Binder {
 public:
  Binder(const Registry& registry, const PathRules& paths, std::vector<yaml::Problem>& problems,
         ComponentSpec& spec, std::vector<std::string> chain)
      : registry_(registry),
        paths_(paths),
        problems_(problems),
        spec_(spec),
        chain_(std::move(chain)) {}

  void bind(const yaml::Node* params, yaml::Position use_at) {
    const ComponentManifest& component = spec_.component();
    yaml::Node effective;
    effective.kind = yaml::Kind::map;
    if (params != nullptr && params->kind != yaml::Kind::map && !yaml::is_null(*params)) {
      problem(params->at, "params must be a map of names and values");
      for (const ParameterSpec& parameter : component.parameters) {
        if (parameter.type == WEFT_VALUE_COMPONENT) spec_.nested.push_back({parameter.name, {}});
      }
      return;
    }
    yaml::Node corrected = params != nullptr ? *params : yaml::Node{};
    if (params != nullptr) {
      correct_names(corrected);
      params = &corrected;
    }
    const bool unclear = paths_.unclear || corrected.unclear;
    spec_.bound = !unclear;
    const bool has_own_defaults = chooses_preset(params);
    for (const ParameterSpec& parameter : component.parameters) {
      const yaml::Node* given = params != nullptr ? params->find(parameter.name) : nullptr;
      const bool is_value = parameter.type != WEFT_VALUE_COMPONENT && !parameter.required;
      if (given == nullptr && has_own_defaults && is_value)
        continue;  // the component has its own
                   // default
      if (given == nullptr && parameter.required) {
        spec_.bound = false;
        if (unclear) continue;
        problem(
            params != nullptr ? params->at : use_at,
            component.id + " requires the parameter '" + parameter.name + "': " + parameter.help);
        continue;
      }
      yaml::Node value = given != nullptr ? *given : parameter.default_value;
      if (given == nullptr) value.at = use_at;
      yaml::Node resolved = value;
      const std::size_t before = problems_.size();
      bind_one(parameter, value, given != nullptr, resolved);
      const bool legal = problems_.size() == before || parameter.type == WEFT_VALUE_COMPONENT;
      spec_.bound = spec_.bound && legal;
      effective.entries.push_back({parameter.name, value.at, std::move(resolved)});
    }
    spec_.effective.entries.push_back({"params", use_at, std::move(effective)});
  }

 private:
  /// True if `preset` has another value than by default. Then the manifest's defaults of the other
  /// parameters do not hold.
  bool chooses_preset(const yaml::Node* params) const {
    const yaml::Node* preset = params != nullptr ? params->find("preset") : nullptr;
    if (preset == nullptr || preset->kind != yaml::Kind::scalar) return false;
    const auto& all = spec_.component().parameters;
    return std::any_of(all.begin(), all.end(), [&](const ParameterSpec& each) {
      return each.name == "preset" && each.type == WEFT_VALUE_CHOICE &&
             each.default_value.scalar != preset->scalar;
    });
  }

  void problem(yaml::Position at, std::string message) {
    problems_.push_back({at, std::move(message)});
  }

  void correct_names(yaml::Node& params) {
    const std::string& id = spec_.component().id;
    std::vector<std::string> names;
    for (const ParameterSpec& parameter : spec_.component().parameters) {
      names.push_back(parameter.name);
      if (parameter.was.empty() || params.find(parameter.name) != nullptr) continue;
      for (yaml::Entry& entry : params.entries) {
        if (entry.key == parameter.was) entry.key = parameter.name;
      }
    }
    yaml::correct_keys(params, names, [&](const yaml::Entry& entry, const std::string& near) {
      problem(entry.at, id + " has no parameter " + quote(entry.key) +
                            meant(near, "; see: weft plugins show " + id));
    });
  }

  void wrong(const ParameterSpec& parameter, const yaml::Node& value, const std::string& expected) {
    const bool is_text = value.kind == yaml::Kind::scalar;
    problem(value.at, "'" + parameter.name + "' must be " + expected +
                          (is_text ? ", not " + quote(value.scalar) : ""));
  }

  static std::string with_unit(const std::string& what, const ParameterSpec& parameter) {
    return parameter.unit.empty() ? what : what + " in " + parameter.unit + " (without the unit)";
  }

  bool in_range(const ParameterSpec& parameter, const yaml::Node& value, double number) {
    if (!std::isfinite(number)) {
      wrong(parameter, value, "a finite number");
      return false;
    }
    if (!parameter.bounded || (number >= parameter.minimum && number <= parameter.maximum)) {
      return true;
    }
    out_of_range(parameter, value);
    return false;
  }

  bool in_range(const ParameterSpec& parameter, const yaml::Node& value, std::int64_t number) {
    if (number >= parameter.integer_minimum && number <= parameter.integer_maximum) return true;
    out_of_range(parameter, value);
    return false;
  }

  void out_of_range(const ParameterSpec& parameter, const yaml::Node& value) {
    std::ostringstream message;
    message << "'" << parameter.name << "' is " << escaped(value.scalar, 80) << ", legal is "
            << parameter.minimum << " to " << parameter.maximum
            << (parameter.unit.empty() ? "" : " ") << parameter.unit;
    problem(value.at, message.str());
  }

  void bind_one(const ParameterSpec& parameter, const yaml::Node& value, bool given,
                yaml::Node& resolved) {
    switch (parameter.type) {
      case WEFT_VALUE_F64:
        return parameter.is_vector ? bind_numbers(parameter, value) : bind_number(parameter, value);
      case WEFT_VALUE_I64:
        return parameter.is_vector ? bind_integers(parameter, value)
                                   : bind_integer(parameter, value);
      case WEFT_VALUE_BOOL:
        return bind_flag(parameter, value);
      case WEFT_VALUE_CHOICE:
        return bind_choice(parameter, value);
      case WEFT_VALUE_TEXT:
        return parameter.is_vector ? bind_texts(parameter, value)
                                   : bind_text(parameter, value, given, resolved);
      case WEFT_VALUE_INPUT_PATH:
      case WEFT_VALUE_OUTPUT_PATH:
        return bind_path(parameter, value, given, resolved);
      case WEFT_VALUE_LABELS:
        return bind_labels(parameter, value);
      case WEFT_VALUE_COMPONENT:
        return bind_component(parameter, value, given, resolved);
    }
  }

  void bind_number(const ParameterSpec& parameter, const yaml::Node& value) {
    const auto number = yaml::as_double(value);
    if (!number) return wrong(parameter, value, with_unit("a number", parameter));
    if (in_range(parameter, value, *number)) spec_.arguments.add_number(parameter.name, *number);
  }

  void bind_numbers(const ParameterSpec& parameter, const yaml::Node& value) {
    auto numbers = numbers_of<double>(parameter, value, &yaml::as_double, "a list of numbers");
    if (numbers) spec_.arguments.add_numbers(parameter.name, *std::move(numbers));
  }

  void bind_integers(const ParameterSpec& parameter, const yaml::Node& value) {
    auto numbers =
        numbers_of<std::int64_t>(parameter, value, &yaml::as_int64, "a list of whole numbers");
    if (numbers) spec_.arguments.add_integers(parameter.name, *std::move(numbers));
  }

  /// Nothing if a number is illegal, which has been reported.
  template <class Number>
  std::optional<std::vector<Number>> numbers_of(const ParameterSpec& parameter,
                                                const yaml::Node& value,
                                                std::optional<Number> (*read)(const yaml::Node&),
                                                const char* expected) {
    std::vector<Number> numbers;
    if (value.kind != yaml::Kind::sequence) {
      wrong(parameter, value, with_unit(expected, parameter));
      return std::nullopt;
    }
    for (const yaml::Node& item : value.items) {
      const std::optional<Number> number = read(item);
      if (!number) wrong(parameter, item, with_unit(expected, parameter));
      if (!number || !in_range(parameter, item, *number)) return std::nullopt;
      numbers.push_back(*number);
    }
    return numbers;
  }

  void bind_integer(const ParameterSpec& parameter, const yaml::Node& value) {
    const auto number = yaml::as_int64(value);
    if (!number) return wrong(parameter, value, with_unit("a whole number", parameter));
    if (in_range(parameter, value, *number)) {
      spec_.arguments.add_integer(parameter.name, *number);
    }
  }

  void bind_flag(const ParameterSpec& parameter, const yaml::Node& value) {
    const auto flag = yaml::as_bool(value);
    if (!flag) return wrong(parameter, value, "true or false");
    spec_.arguments.add_flag(parameter.name, *flag);
  }

  void bind_choice(const ParameterSpec& parameter, const yaml::Node& value) {
    const auto& choices = parameter.choices;
    if (value.kind == yaml::Kind::scalar &&
        std::find(choices.begin(), choices.end(), value.scalar) != choices.end()) {
      return spec_.arguments.add_texts(parameter.name, parameter.type, {value.scalar});
    }
    std::string expected;
    for (const std::string& choice : choices) expected += (expected.empty() ? "" : ", ") + choice;
    wrong(parameter, value, "one of: " + expected);
  }

  void bind_text(const ParameterSpec& parameter, const yaml::Node& value, bool given,
                 yaml::Node& resolved) {
    if (value.kind != yaml::Kind::scalar) return wrong(parameter, value, "a text");
    const auto text = given ? expand_variables(value.scalar, paths_) : value.scalar;
    if (!text) return problem(value.at, text.error().message);
    if (*text != value.scalar) resolved = yaml::text_node(*text, value.at);
    if (auto hidden = hidden_text(parameter.name, value.scalar, *text)) {
      spec_.hidden[parameter.name] = *std::move(hidden);
    }
    spec_.arguments.add_texts(parameter.name, parameter.type, {*text});
  }

  void bind_texts(const ParameterSpec& parameter, const yaml::Node& value) {
    if (value.kind != yaml::Kind::sequence) return wrong(parameter, value, "a list of texts");
    std::vector<std::string> texts;
    for (const yaml::Node& item : value.items) {
      if (item.kind != yaml::Kind::scalar) return wrong(parameter, item, "a list of texts");
      texts.push_back(item.scalar);
    }
    spec_.arguments.add_texts(parameter.name, parameter.type, std::move(texts), true);
  }

  void bind_path(const ParameterSpec& parameter, const yaml::Node& value, bool given,
                 yaml::Node& resolved) {
    if (value.kind != yaml::Kind::scalar) return wrong(parameter, value, "a path");
    if (value.scalar.empty()) {
      if (parameter.required) wrong(parameter, value, "a path");
      return;
    }
    const bool input = parameter.type == WEFT_VALUE_INPUT_PATH;
    if (input && !parameter.names_files(value.scalar)) {
      return spec_.arguments.add_texts(parameter.name, parameter.type, {value.scalar});
    }
    const auto expanded = given || input
                              ? expand_path(value.scalar, paths_)
                              : Result<std::string>(default_output(value.scalar, spec_.arguments));
    if (!expanded) return problem(value.at, expanded.error().message);
    const auto source = to_index(value.at.source);
    const fs::path folder = input ? paths_.input_folders.at(source) : paths_.output_folder;
    const std::string path = (folder / *expanded).lexically_normal().string();
    const bool pattern = path.find_first_of("*?[") != std::string::npos;
    std::error_code code;
    if (input && !pattern && !fs::exists(path, code)) {
      const std::string hint = numbering_hint(value.scalar);
      return problem(value.at, "'" + parameter.name + "': there is no file " + escaped(path) +
                                   (hint.empty() ? "" : "; " + escaped(hint)));
    }
    resolved = yaml::text_node(input ? path : path_in_run(path, paths_), value.at);
    spec_.arguments.add_texts(parameter.name, parameter.type, {path});
  }

  void bind_labels(const ParameterSpec& parameter, const yaml::Node& value) {
    if (value.kind != yaml::Kind::map && !yaml::is_null(value)) {
      return wrong(parameter, value, "a map of texts");
    }
    std::vector<std::string> texts;
    for (const yaml::Entry& entry : value.entries) {
      if (entry.value.kind != yaml::Kind::scalar) {
        return wrong(parameter, entry.value, "a map of texts");
      }
      texts.push_back(entry.key);
      texts.push_back(entry.value.scalar);
    }
    spec_.arguments.add_texts(parameter.name, parameter.type, std::move(texts));
  }

  void bind_component(const ParameterSpec& parameter, const yaml::Node& value, bool given,
                      yaml::Node& resolved) {
    if (given && value.kind != yaml::Kind::map) {
      spec_.nested.push_back({parameter.name, {}});
      return wrong(parameter, value,
                   "a component, such as {use: " + parameter.default_value.scalar + "}");
    }
    yaml::Node node = value;
    bool says_more = false;
    const std::vector<std::string> keys = yaml::names_of(component_keys());
    yaml::correct_keys(node, keys, [&](const yaml::Entry& entry, const std::string&) {
      says_more = true;
      problem(entry.at, "a nested component has no key " + quote(entry.key) +
                            "; it has use and params" + meant_parameter(parameter, entry.key));
    });
    // With parameters alone it is the default one.
    const yaml::Node default_use = yaml::text_node(parameter.default_value.scalar, value.at);
    const bool is_chosen = given && node.find("use") != nullptr;
    const bool is_default = !is_chosen && (!given || node.find("params") != nullptr);
    const yaml::Node* use = is_default ? &default_use : node.find("use");
    ComponentSpec nested;
    if (use == nullptr) {
      if (value.unclear || says_more) {
        spec_.nested.push_back({parameter.name, {}});
        return;
      }
      problem(value.at, "'" + parameter.name + "' lacks the key 'use'");
    } else if (may_hold(parameter, *use, is_chosen)) {
      nested = resolve(registry_, *use, given ? node.find("params") : nullptr, paths_, problems_,
                       chain_);
      resolved = nested.effective;
    }
    spec_.nested.push_back({parameter.name, std::move(nested)});
  }

  /// The suggestion for a key that is a parameter of the default component.
  std::string meant_parameter(const ParameterSpec& parameter, const std::string& key) const {
    const Installed* component = registry_.find(parameter.default_value.scalar);
    if (component == nullptr) return {};
    const auto& parameters = component->component.parameters;
    const bool has = std::any_of(parameters.begin(), parameters.end(),
                                 [&](const ParameterSpec& each) { return each.name == key; });
    return has ? meant(parameter.name + ".params." + key) : "";
  }

  bool may_hold(const ParameterSpec& parameter, const yaml::Node& use, bool given) {
    if (!given && std::find(chain_.begin(), chain_.end(), use.scalar) != chain_.end()) {
      problem(use.at, "'" + parameter.name + "' of " + chain_.back() + " is " + use.scalar +
                          " by default, which holds it; give another one");
      return false;
    }
    if (use.kind != yaml::Kind::scalar || use.scalar.starts_with(parameter.role + "/")) return true;
    problem(use.at, "'" + parameter.name + "' must be one of " + parameter.role + "/..., not " +
                        quote(use.scalar) +
                        meant(registry_.nearest_of_role(use.scalar, parameter.role)));
    return false;
  }

  const Registry& registry_;
  const PathRules& paths_;
  std::vector<yaml::Problem>& problems_;
  ComponentSpec& spec_;
  std::vector<std::string> chain_;  ///< ids from the outermost component to this one
};

ComponentSpec resolve(const Registry& registry, const yaml::Node& use, const yaml::Node* params,
                      const PathRules& paths, std::vector<yaml::Problem>& problems,
                      std::vector<std::string> parents) {
  ComponentSpec spec;
  if (use.kind != yaml::Kind::scalar) {
    problems.push_back({use.at, "'use' must be the id of a plugin, such as filters/myneighbor"});
    return spec;
  }
  spec.installed = registry.find(use.scalar);
  if (spec.installed == nullptr) {
    problems.push_back({use.at, registry.explain_missing(use.scalar)});
    return spec;
  }
  spec.effective.kind = yaml::Kind::map;
  const std::string& id = spec.component().id;
  spec.effective.entries.push_back({"use", use.at, yaml::plain_node(id, use.at)});
  parents.push_back(id);
  Binder(registry, paths, problems, spec, std::move(parents)).bind(params, use.at);
  return spec;
}

}  // namespace

std::optional<yaml::Position> place_of(const ComponentSpec& spec, std::string_view parameter) {
  const yaml::Node* params = spec.effective.find("params");
  const yaml::Node* value = params != nullptr ? params->find(parameter) : nullptr;
  return value != nullptr ? std::optional(value->at) : std::nullopt;
}

std::string length_parameter(const ComponentSpec& spec) {
  for (const NestedSpec& nested : spec.nested) {
    const Installed* installed = nested.component.installed;
    if (installed == nullptr || installed->component.role() != spec.component().role()) continue;
    return length_parameter(nested.component);
  }
  const std::vector<ParameterSpec>& parameters = spec.component().parameters;
  const auto length = std::find_if(parameters.begin(), parameters.end(), [](const auto& each) {
    return each.type == WEFT_VALUE_F64 && !each.is_vector && each.unit == "m";
  });
  return length != parameters.end() ? length->name : "";
}

std::optional<ComponentSpec> resolve_component(const Registry& registry, const yaml::Node& use,
                                               const yaml::Node* params, const PathRules& paths,
                                               std::vector<yaml::Problem>& problems) {
  const std::size_t before = problems.size();
  ComponentSpec spec = resolve(registry, use, params, paths, problems, {});
  return problems.size() > before ? std::nullopt : std::optional(std::move(spec));
}

ComponentSpec resolve_known_part(const Registry& registry, const yaml::Node& use,
                                 const yaml::Node* params, const PathRules& paths,
                                 std::vector<yaml::Problem>& problems) {
  return resolve(registry, use, params, paths, problems, {});
}

}  // namespace weft::host
