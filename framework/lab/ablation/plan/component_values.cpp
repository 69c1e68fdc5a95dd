// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <fnmatch.h>

#include <algorithm>
#include <weft/core/quote.hpp>
#include <weft/core/suggest.hpp>

#include "host/loading/registry.hpp"
#include "lab/ablation/plan/plan_parts.hpp"

namespace weft::lab {
namespace {

using Components = std::vector<const host::ComponentManifest*>;

std::string name_of(const host::ComponentManifest& component) {
  return component.id.substr(component.id.find('/') + 1);
}

/// True if "filters/aem", "filters/a*" or, without a role, "aem" means a component.
bool means(const std::string& word, const host::ComponentManifest& component) {
  const bool whole = word.find('/') != std::string::npos;
  const std::string name = whole ? component.id : name_of(component);
  return fnmatch(word.c_str(), name.c_str(), 0) == 0;
}

class ComponentAxis {
 public:
  ComponentAxis(const yaml::Node& axis, const host::Registry& registry, PlanValues& values)
      : axis_(axis), registry_(registry), values_(values) {}

  std::vector<NamedPatch> values() {
    const std::size_t before = values_.count();
    if (!values_.has(axis_, "stage", "an axis with 'use'")) return {};
    stage_ = values_.text(*axis_.find("stage"), "'stage'");
    read_use(*axis_.find("use"));
    if (const yaml::Node* except = axis_.find("except")) leave_out(*except);
    if (chosen_.empty() && values_.count() == before) {
      values_.problem(axis_.find("use")->at, "'except' leaves nothing of 'use'");
    }
    if (const yaml::Node* set = axis_.find("set")) check_set(*set);
    const yaml::Node* sweep = axis_.find("sweep");
    if (sweep != nullptr) check_sweep(*sweep);
    std::vector<NamedPatch> found;
    if (values_.count() > before) return found;
    for (const host::ComponentManifest* component : chosen_) add(*component, sweep, found);
    return found;
  }

 private:
  /// A text, or the texts of a list.
  std::vector<std::pair<std::string, yaml::Position>> words(const yaml::Node& node,
                                                            const char* what) {
    if (node.kind == yaml::Kind::sequence) return values_.texts(node, what);
    return {{values_.text(node, what), node.at}};
  }

  void read_use(const yaml::Node& use) {
    for (const auto& [word, at] : words(use, "'use'")) {
      if (word.empty()) continue;
      Components meant;
      for (const host::Installed& entry : registry_.installed()) {
        if (!entry.shadowed && means(word, entry.component)) meant.push_back(&entry.component);
      }
      std::sort(meant.begin(), meant.end(),
                [](const auto* a, const auto* b) { return a->id < b->id; });
      if (meant.empty()) refuse(word, at);
      for (const host::ComponentManifest* component : meant) {
        const bool is_new = std::find(chosen_.begin(), chosen_.end(), component) == chosen_.end();
        if (is_new) chosen_.push_back(component);
      }
    }
  }

  void refuse(const std::string& word, yaml::Position at) {
    if (word.find_first_of("*?[") == std::string::npos && word.find('/') != std::string::npos) {
      return values_.problem(at, registry_.explain_missing(word));
    }
    std::vector<std::string> known;
    for (const host::Installed& entry : registry_.installed()) {
      const std::string all = entry.component.role() + "/*";
      if (std::find(known.begin(), known.end(), all) == known.end()) known.push_back(all);
      known.push_back(entry.component.id);
    }
    values_.problem(at, "no installed plugin is meant by " + quote(word) +
                            did_you_mean(word, known, "; see: weft plugins list"));
  }

  void leave_out(const yaml::Node& except) {
    const std::vector<std::string> known = names();
    for (const auto& [word, at] : words(except, "'except'")) {
      const std::size_t count = std::erase_if(
          chosen_, [&, &what = word](const auto* component) { return means(what, *component); });
      if (count == 0 && !word.empty())
        values_.unknown(at, "component in 'use' that is", word, known);
    }
  }

  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const host::ComponentManifest* component : chosen_) all.push_back(name_of(*component));
    return all;
  }

  void check_set(const yaml::Node& set) {
    const char* form =
        "'set' beside 'use' must be a map of components and their parameters, such as "
        "{aem: {least_confidence: 0}}";
    if (set.kind != yaml::Kind::map) return values_.problem(set.at, form);
    for (const yaml::Entry& entry : set.entries) {
      const bool known = std::any_of(chosen_.begin(), chosen_.end(), [&](const auto* component) {
        return means(entry.key, *component);
      });
      if (!known) values_.unknown(entry.at, "component in 'use' that is", entry.key, names());
      if (entry.value.kind != yaml::Kind::map) values_.problem(entry.value.at, form);
    }
  }

  void check_sweep(const yaml::Node& sweep) {
    if (sweep.kind != yaml::Kind::scalar || sweep.scalar != "threshold") {
      return values_.problem(sweep.at,
                             "'sweep' beside 'use' must be threshold: the parameter and the values "
                             "that each component declares");
    }
    std::string lacking;
    for (const host::ComponentManifest* component : chosen_) {
      if (component->sweep) continue;
      lacking += (lacking.empty() ? "" : ", ") + component->id;
    }
    if (lacking.empty()) return;
    values_.problem(sweep.at, "no threshold to sweep is declared by " + lacking +
                                  "; name them in 'except', and in 'values' what they are to do");
  }

  void add(const host::ComponentManifest& component, const yaml::Node* sweep,
           std::vector<NamedPatch>& found) {
    const yaml::Position stage_at = axis_.find("stage")->at, use_at = axis_.find("use")->at;
    yaml::Node patch =
        setting_patch(stage_ + ".use", stage_at, yaml::text_node(component.id, use_at));
    const yaml::Node* set = axis_.find("set");
    for (const yaml::Entry& entry : set != nullptr ? set->entries : std::vector<yaml::Entry>{}) {
      if (!means(entry.key, component)) continue;
      for (const yaml::Entry& parameter : entry.value.entries) {
        patch = with_setting(std::move(patch), stage_ + "." + parameter.key, parameter.at,
                             parameter.value);
      }
    }
    if (sweep == nullptr) {
      found.push_back({name_of(component), std::move(patch)});
      return;
    }
    for (const double number : component.sweep->values) {
      const std::string text = fmt::format("{}", number);
      found.push_back({name_of(component) + "_" + text,
                       with_setting(patch, stage_ + "." + component.sweep->parameter, sweep->at,
                                    yaml::plain_node(text, sweep->at))});
    }
  }

  const yaml::Node& axis_;
  const host::Registry& registry_;
  PlanValues& values_;
  std::string stage_;
  Components chosen_;
};

}  // namespace

std::vector<NamedPatch> component_values(const yaml::Node& axis, const host::Registry& registry,
                                         PlanValues& values) {
  return ComponentAxis(axis, registry, values).values();
}

}  // namespace weft::lab
