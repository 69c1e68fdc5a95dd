// SPDX-License-Identifier: Apache-2.0
#include "host/loading/former_names.hpp"

#include <algorithm>
#include <weft/core/quote.hpp>

namespace weft::host {
namespace {

struct RenamedComponent {
  std::string_view before, after;
};

/// A parameter declares its former name itself (Params::formerly); an id has no such place.
constexpr RenamedComponent kRenamed[] = {{"solvers/plain_start", "solvers/initial_guess"}};

yaml::Entry* entry_of(yaml::Node& map, std::string_view key) {
  const auto found = std::find_if(map.entries.begin(), map.entries.end(),
                                  [&](const yaml::Entry& entry) { return entry.key == key; });
  return found != map.entries.end() ? &*found : nullptr;
}

class Renamer {
 public:
  Renamer(const Registry& registry, std::vector<FormerName>& found,
          std::vector<yaml::Problem>& problems)
      : registry_(registry), found_(found), problems_(problems) {}

  void component(yaml::Node& over, const yaml::Node* base, const std::string& default_id) {
    if (over.kind != yaml::Kind::map) return;
    yaml::Entry* use = entry_of(over, "use");
    if (use != nullptr) rename_id(use->value);
    const yaml::Node* before = base != nullptr ? base->find("use") : nullptr;
    const std::string base_id = before != nullptr ? before->scalar : default_id;
    const std::string id = use != nullptr ? use->value.scalar : base_id;
    const Installed* installed = registry_.find(id);
    if (installed == nullptr) return;
    for (const char* block : {"params", "template_params"}) {
      yaml::Entry* given = entry_of(over, block);
      if (given == nullptr) continue;
      // Another component drops the parameters of the one that it replaces.
      const yaml::Node* below = base != nullptr && id == base_id ? base->find(block) : nullptr;
      parameters(given->value, below, installed->component);
    }
  }

 private:
  void rename_id(yaml::Node& use) {
    const Installed* installed = registry_.find(use.scalar);
    if (installed == nullptr || installed->component.id == use.scalar) return;
    found_.push_back({use.at, use.scalar, installed->component.id, "component"});
    use.scalar = installed->component.id;
  }

  void parameters(yaml::Node& over, const yaml::Node* base, const ComponentManifest& of) {
    if (over.kind != yaml::Kind::map) return;
    for (const ParameterSpec& parameter : of.parameters) {
      if (!parameter.was.empty()) rename(over, parameter, of.id);
      if (parameter.is_deprecated) note(over, parameter, of.id);
      if (parameter.type != WEFT_VALUE_COMPONENT) continue;
      yaml::Entry* nested = entry_of(over, parameter.name);
      if (nested == nullptr) continue;
      component(nested->value, base != nullptr ? base->find(parameter.name) : nullptr,
                parameter.default_value.scalar);
    }
  }

  void note(const yaml::Node& params, const ParameterSpec& parameter, const std::string& id) {
    for (const yaml::Entry& entry : params.entries) {
      if (entry.key != parameter.name) continue;
      found_.push_back({entry.at, parameter.name, "", "parameter of " + id, parameter.help});
    }
  }

  void rename(yaml::Node& params, const ParameterSpec& parameter, const std::string& id) {
    yaml::Entry* former = entry_of(params, parameter.was);
    if (former == nullptr) return;
    if (params.find(parameter.name) != nullptr) {
      problems_.push_back({former->at, quote(parameter.was) + " is the former name of " +
                                           quote(parameter.name) +
                                           ", which is given too: remove one of them"});
      return;
    }
    found_.push_back({former->at, parameter.was, parameter.name, "parameter of " + id});
    former->key = parameter.name;
  }

  const Registry& registry_;
  std::vector<FormerName>& found_;
  std::vector<yaml::Problem>& problems_;
};

}  // namespace

std::string FormerName::message() const {
  const std::string advice = after.empty() ? help : "use " + quote(after);
  return quote(before) + " (" + what + ") is deprecated: " + advice;
}

std::string_view current_id(std::string_view id) {
  for (const RenamedComponent& each : kRenamed) {
    if (each.before == id) return each.after;
  }
  return id;
}

std::string current_parameter(const Registry& registry, std::string_view id,
                              const std::string& name) {
  const Installed* installed = registry.find(id);
  if (installed == nullptr) return name;
  for (const ParameterSpec& parameter : installed->component.parameters) {
    if (!parameter.was.empty() && parameter.was == name) return parameter.name;
  }
  return name;
}

void use_current_names(yaml::Node& over, const yaml::Node* base, const std::string& default_id,
                       const Registry& registry, std::vector<FormerName>& found,
                       std::vector<yaml::Problem>& problems) {
  Renamer(registry, found, problems).component(over, base, default_id);
}

}  // namespace weft::host
