// SPDX-License-Identifier: Apache-2.0
#include "pipeline/configuration/inherited_values.hpp"

#include <algorithm>
#include <filesystem>
#include <weft/core/quote.hpp>

namespace weft {
namespace {

using host::ParameterSpec;

/// The file that a component is made from; nothing where it names none, or not in a legal way.
std::optional<std::string> file_of(const yaml::Node& part, const std::string& parameter,
                                   const host::Registry& registry, const host::PathRules& paths) {
  std::vector<yaml::Problem> reported_elsewhere;
  const auto spec = host::resolve_known_part(registry, *part.find("use"), part.find("params"),
                                             paths, reported_elsewhere);
  const yaml::Node* params = spec.effective.find("params");
  const yaml::Node* path = params != nullptr ? params->find(parameter) : nullptr;
  if (path == nullptr || path->scalar.empty()) return std::nullopt;
  std::error_code code;
  const auto canonical = std::filesystem::weakly_canonical(path->scalar, code);
  return code ? path->scalar : canonical.string();
}

/// True if a value of a template belongs to one file: its scale, or places in a photograph.
bool is_scale(const ParameterSpec& parameter) {
  return parameter.type == WEFT_VALUE_F64 &&
         (parameter.is_vector ? parameter.unit == "px" : parameter.unit == "m");
}

class Check {
 public:
  Check(PipelineDocument& document, const host::Registry& registry, const host::PathRules& paths)
      : document_(document), registry_(registry), paths_(paths) {}

  InheritedValues run() {
    for (yaml::Entry& entry : document_.root.entries) {
      if (entry.key == "source" || entry.key == "template") check(entry.key, entry.value);
    }
    return std::move(found_);
  }

 private:
  void check(const std::string& key, yaml::Node& part) {
    const yaml::Node* use = part.find("use");
    const auto params =
        std::find_if(part.entries.begin(), part.entries.end(),
                     [](const yaml::Entry& entry) { return entry.key == "params"; });
    if (use == nullptr || params == part.entries.end()) return;
    const host::Installed* installed = registry_.find(use->scalar);
    if (installed == nullptr) return;
    const auto& parameters = installed->component.parameters;
    const auto path =
        std::find_if(parameters.begin(), parameters.end(), [](const ParameterSpec& parameter) {
          return parameter.type == WEFT_VALUE_INPUT_PATH && parameter.required;
        });
    if (path == parameters.end()) return;
    const yaml::Node* given = params->value.find(path->name);
    const auto file = file_of(part, path->name, registry_, paths_);
    if (given == nullptr || !file) return;
    const auto is_of_another = [&](const yaml::Node& value) {
      if (value.at.source == given->at.source) return false;
      const std::optional<std::string> own = file_with(key, value.at.source, path->name);
      return own && *own != *file;
    };
    for (yaml::Entry& entry : params->value.entries) {
      const auto parameter =
          std::find_if(parameters.begin(), parameters.end(),
                       [&](const ParameterSpec& each) { return each.name == entry.key; });
      if (parameter == parameters.end()) continue;
      if (key == "template" && is_scale(*parameter) && is_of_another(entry.value)) {
        refuse(*path, *given, *parameter, entry.value);
      } else if (key == "source" && parameter->type == WEFT_VALUE_LABELS) {
        std::erase_if(entry.value.entries, [&](const yaml::Entry& label) {
          const bool is_stale = is_of_another(label.value);
          if (is_stale) drop(*path, *given, *parameter, label);
          return is_stale;
        });
      }
    }
  }

  /// The file that the part was made from in the text of this source, if that is a file.
  std::optional<std::string> file_with(const std::string& key, int source,
                                       const std::string& parameter) const {
    for (const PartOfFile& part : document_.parts) {
      if (part.source != source || part.key != key || part.node.find("use") == nullptr) continue;
      return file_of(part.node, parameter, registry_, paths_);
    }
    return std::nullopt;
  }

  void refuse(const ParameterSpec& path, const yaml::Node& given, const ParameterSpec& parameter,
              const yaml::Node& value) {
    found_.problems.push_back(
        {given.at, "'" + path.name + "' is another file than the one that '" + parameter.name +
                       "' describes" +
                       (value.kind == yaml::Kind::scalar ? ", " + escaped(value.scalar, 40) : "") +
                       " in " + place_in(document_.sources, value.at) + ": give '" +
                       parameter.name + "' of this one too (" + parameter.help + ")"});
  }

  void drop(const ParameterSpec& path, const yaml::Node& given, const ParameterSpec& parameter,
            const yaml::Entry& label) {
    found_.warnings.push_back(
        {given.at, "'" + path.name + "' is another one than that which '" + parameter.name +
                       "' belongs to: its " + quote(label.key) + " in " +
                       place_in(document_.sources, label.at) + " is not used"});
  }

  PipelineDocument& document_;
  const host::Registry& registry_;
  const host::PathRules& paths_;
  InheritedValues found_;
};

}  // namespace

InheritedValues check_inherited_values(PipelineDocument& document, const host::Registry& registry,
                                       const host::PathRules& paths) {
  return Check(document, registry, paths).run();
}

}  // namespace weft
