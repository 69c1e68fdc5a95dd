// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <set>
#include <weft/core/suggest.hpp>
#include <weft/sdk/roles.hpp>

#include "wiring.hpp"

namespace weft {
namespace {

/// What a component is given: `required` or used when present.
struct Demand {
  std::string slot;
  bool required;
};

const Role& role_named(const std::map<std::string, Role>& roles, const std::string& name) {
  return roles.at(name);
}

/// The method that takes a frame's data: the last one of sources and sinks' three, else the first.
const RoleMethod& main_method(const Role& role) {
  const std::size_t index = role.name == "sinks" ? 1 : role.name == "sources" ? 2 : 0;
  return role.methods[index];
}

using host::ComponentManifest;

constexpr int kLongestLag = 1000;  // [frames]
constexpr int kRefused = -2;       // instead of a value: a mistake has been reported
constexpr std::string_view kPrevious = "previous.";

/// Sources have a choice; they say what they produce.
bool declares(const ComponentManifest& component, const std::string& slot) {
  const auto& made = component.produces;
  return std::find(made.begin(), made.end(), slot) != made.end();
}

class Wiring {
 public:
  Wiring(const PipelineConfig& config, const host::Registry& registry,
         std::vector<yaml::Problem>& problems)
      : config_(config), registry_(registry), problems_(problems) {
    for (Role& role : all_roles()) roles_.emplace(role.name, role);
  }

  Graph wire() {
    const std::size_t before = problems_.size();
    add_given();
    for (std::size_t i = 0; i < config_.stages.size(); ++i) {
      const StageConfig& stage = config_.stages[i];
      Node node = connect(stage);
      for (const std::string& slot : products_of(stage.component.component())) {
        node.outputs.push_back(add(slot, static_cast<int>(i), stage.name));
      }
      if (stage.component.component().role() == "filters" && !node.inputs.empty()) {
        graph_.values.back().filtered = node.inputs.front().value;
      }
      graph_.stages.push_back(std::move(node));
    }
    for (const StageConfig& sink : config_.sinks) graph_.sinks.push_back(connect(sink));
    // What is read by nobody may only follow from another mistake.
    if (problems_.size() == before && !has_broken_rules()) {
      refuse_unread(config_, graph_, problems_);
    }
    return std::move(graph_);
  }

 private:
  /// Whether `from` cannot be understood, which has been reported.
  static bool has_broken_rule(const StageConfig& stage) {
    return std::any_of(stage.from.begin(), stage.from.end(),
                       [](const FromRule& rule) { return rule.names.empty(); });
  }

  bool has_broken_rules() const {
    return std::any_of(config_.stages.begin(), config_.stages.end(), has_broken_rule) ||
           std::any_of(config_.sinks.begin(), config_.sinks.end(), has_broken_rule);
  }

  int add(const std::string& slot, int stage, const std::string& name, int lag = 0) {
    graph_.values.push_back({slot, stage, name, lag});
    return static_cast<int>(graph_.values.size()) - 1;
  }

  /// Values that exist before the first stage. previous.* is fed back by the host.
  void add_given() {
    if (config_.source) {
      const ComponentManifest& source = config_.source->component.component();
      for (const RoleSlot& output : main_method(roles_.at("sources")).outputs) {
        if (declares(source, output.name)) add(output.name, -1, "sources");
      }
    }
    add("camera", -1, "sources");
    add("template", -1, "templates");
    std::set<std::string> fed_back;
    for (const StageConfig& stage : config_.stages) {
      const auto made = products_of(stage.component.component());
      fed_back.insert(made.begin(), made.end());
    }
    for (const std::string& slot : fed_back) add("previous." + slot, -1, "previous", 1);
  }

  /// What the component and those nested in it want of the role's inputs.
  void collect(const host::ComponentSpec& spec, const RoleMethod& offered,
               std::vector<Demand>& demands, yaml::Position at, bool nested) {
    const ComponentManifest& component = spec.component();
    const auto want = [&](const std::string& slot, bool required) {
      const bool is_offered =
          std::any_of(offered.inputs.begin(), offered.inputs.end(),
                      [&](const RoleSlot& input) { return input.name == slot; });
      if (!is_offered) {
        if (!nested)
          problems_.push_back({at, component.id + " wants '" + slot + "', which " +
                                       component.role() + " are never given"});
        return;
      }
      if (slot == "ground_truth" && !component.uses_truth && component.role() != "sinks") {
        problems_.push_back({at, component.id + " reads ground_truth without saying uses_truth"});
        return;
      }
      for (Demand& demand : demands) {
        if (demand.slot != slot) continue;
        demand.required = demand.required || required;
        return;
      }
      demands.push_back({slot, required && !slot.starts_with("previous.")});
    };
    for (const RoleSlot& input : main_method(role_named(roles_, component.role())).inputs) {
      if (input.required) want(input.name, true);
    }
    for (const std::string& slot : component.needs) want(slot, true);
    for (const std::string& slot : component.reads) want(slot, false);
    for (const auto& [parameter, child] : spec.nested) collect(child, offered, demands, at, true);
  }

  Node connect(const StageConfig& stage) {
    const ComponentManifest& component = stage.component.component();
    const RoleMethod& method = main_method(role_named(roles_, component.role()));
    std::vector<Demand> demands;
    collect(stage.component, method, demands, stage.at, false);
    check_from(stage, demands);
    Node node;
    for (const Demand& demand : demands) {
      const bool unites = takes_several(component, demand.slot);
      if (unites && chosen(stage, demand.slot) == nullptr && !has_broken_rule(stage)) {
        problems_.push_back({stage.at, nothing_to_unite(graph_, stage, demand.slot)});
        continue;
      }
      const std::vector<int> values = choose(stage, demand.slot);
      for (const int value : values) node.inputs.push_back({demand.slot, value, demand.required});
      if (values.empty() && demand.required && !chosen(stage, demand.slot)) {
        problems_.push_back(
            {stage.at, missing_input(config_, registry_, component.id, demand.slot)});
      }
    }
    return node;
  }

  void check_from(const StageConfig& stage, const std::vector<Demand>& demands) {
    std::vector<std::string> slots;
    for (const Demand& demand : demands) slots.push_back(demand.slot);
    const ComponentManifest& component = stage.component.component();
    for (const FromRule& rule : stage.from) {
      if (rule.names.empty()) continue;  // reported
      const bool read = std::find(slots.begin(), slots.end(), rule.slot) != slots.end();
      if (rule.slot == "template_keypoints") {
        problems_.push_back({rule.at, "'from' chooses both kinds of keypoints with: keypoints"});
      } else if (!read) {
        const std::string near = nearest(rule.slot, slots);
        problems_.push_back({rule.at, component.id + " does not read '" + rule.slot + "'" +
                                          (near.empty() ? "" : "; did you mean '" + near + "'?")});
      } else if (rule.names.size() > 1 && !takes_several(component, rule.slot)) {
        problems_.push_back({rule.at, component.id + " takes one '" + rule.slot + "' only"});
      }
    }
  }

  static bool takes_several(const ComponentManifest& component, const std::string& slot) {
    return component.role() == "matchers" && slot == "correspondences";
  }

  /// The rule with which a stage chooses where a slot comes from, or null.
  static const FromRule* chosen(const StageConfig& stage, const std::string& slot) {
    const std::string chosen_by = slot == "template_keypoints" ? "keypoints" : slot;
    for (const FromRule& rule : stage.from) {
      if (rule.slot == chosen_by) return &rule;
    }
    return nullptr;
  }

  std::vector<int> choose(const StageConfig& stage, const std::string& slot) {
    const FromRule* rule = chosen(stage, slot);
    if (rule == nullptr) {
      const int value = graph_.latest(slot);
      return value >= 0 ? std::vector<int>{value} : std::vector<int>{};
    }
    std::vector<int> values;
    for (const std::string& name : rule->names) {
      // In place of the previous value a stage may take one of this frame, to refine it.
      const std::string made = slot.substr(slot.starts_with(kPrevious) ? kPrevious.size() : 0);
      const int value = name.starts_with(kPrevious) ? earlier(*rule, name) : named(made, name);
      if (value == kRefused) continue;
      if (value >= 0) {
        values.push_back(value);
      } else if (slot == rule->slot) {
        problems_.push_back({rule->at, wrong_name(config_, graph_, stage, made, name)});
      }
    }
    return values;
  }

  /// The value of "previous.TYPE@k", for an input of that type.
  int earlier(const FromRule& rule, const std::string& name) {
    const std::size_t at = std::min(name.find('@'), name.size());
    const std::string slot = name.substr(0, at);
    const std::string type = slot.substr(kPrevious.size());
    const bool reads_previous = rule.slot.starts_with(kPrevious);
    if (type != (reads_previous ? rule.slot.substr(rule.slot.find('.') + 1) : rule.slot)) {
      problems_.push_back({rule.at, "'" + rule.slot + "' cannot be read from '" + name + "'"});
      return kRefused;
    }
    const auto lag = at == name.size() ? 1 : lag_in(name.substr(at + 1));
    if (!lag) {
      problems_.push_back({rule.at, "'" + name + "' must be " + slot + " or " + slot +
                                        "@k, k frames ago, with k from 1 to " +
                                        std::to_string(kLongestLag)});
      return kRefused;
    }
    if (graph_.latest(slot) < 0) {
      problems_.push_back(
          {rule.at, "no stage produces '" + type + "', so that there is no '" + name + "'"});
      return kRefused;
    }
    for (std::size_t i = 0; i < graph_.values.size(); ++i) {
      if (graph_.values[i].slot == slot && graph_.values[i].lag == *lag) return static_cast<int>(i);
    }
    return add(slot, -1, "previous", *lag);
  }

  static std::optional<int> lag_in(const std::string& text) {
    const auto lag = yaml::as_int64(yaml::plain_node(text));
    if (!lag || *lag < 1 || *lag > kLongestLag) return std::nullopt;
    return static_cast<int>(*lag);
  }

  int named(const std::string& slot, const std::string& name) const {
    for (int i = static_cast<int>(graph_.values.size()) - 1; i >= 0; --i) {
      const ValueInfo& value = graph_.values[static_cast<std::size_t>(i)];
      if (value.slot == slot && value.name == name) return i;
    }
    return -1;
  }

  const PipelineConfig& config_;
  const host::Registry& registry_;
  std::vector<yaml::Problem>& problems_;
  std::map<std::string, Role> roles_;
  Graph graph_;
};

}  // namespace

int Graph::latest(const std::string& slot) const {
  for (int i = static_cast<int>(values.size()) - 1; i >= 0; --i) {
    const ValueInfo& value = values[static_cast<std::size_t>(i)];
    if (value.slot == slot && value.lag <= 1) return i;
  }
  return -1;
}

Graph wire(const PipelineConfig& config, const host::Registry& registry,
           std::vector<yaml::Problem>& problems) {
  return Wiring(config, registry, problems).wire();
}

}  // namespace weft
