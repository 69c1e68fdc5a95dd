// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/suggest.hpp>

#include "pipeline/graph/wiring.hpp"

namespace weft {
namespace {

constexpr int kLongestLag = 1000;  // [frames]
constexpr int kRefused = -2;       // instead of a value: no further message is needed
constexpr std::string_view kPrevious = "previous.";
constexpr std::string_view kOther = "other_";  // inputs that only `from` fills
constexpr const char* kOfHost[] = {"frame_report", "run_settings"};  // inputs of sinks that the
                                                                     // host provides

/// The slot of the values that an input can take: "shape" of "previous.shape" and "other_shape".
std::string made_slot(const std::string& input) {
  for (const std::string_view prefix : {kPrevious, kOther}) {
    if (input.starts_with(prefix)) return input.substr(prefix.size());
  }
  return input;
}

/// Sources have a choice and declare their outputs. A program gives an image, its time, and what
/// it announces.
bool may_enter(const PipelineConfig& config, const std::string& slot) {
  if (config.in_program) {
    const auto& given = config.given;
    return slot == "image" || slot == "time" ||
           std::find(given.begin(), given.end(), slot) != given.end();
  }
  if (!config.source || config.source->component.installed == nullptr) return true;
  const auto& made = config.source->component.component().produces;
  return std::find(made.begin(), made.end(), slot) != made.end();
}

class Wiring {
 public:
  Wiring(const PipelineConfig& config, const host::Registry& registry,
         std::vector<yaml::Problem>& problems)
      : config_(config), registry_(registry), problems_(problems) {}

  Graph wire() {
    add_given();
    for (std::size_t i = 0; i < config_.stages.size(); ++i) {
      const StageConfig& stage = config_.stages[i];
      reader_ = i;
      Node node = connect(stage);
      find_conditions(stage, node);
      const auto made = products_of(stage);
      for (const std::string& slot : made.value_or(Words{})) {
        node.outputs.push_back(add(slot, static_cast<int>(i), stage.name));
      }
      if (!made) may_make(stage.role, "");
      if (rules_of(stage.role).marks && !node.inputs.empty()) {
        graph_.values.back().filtered = node.inputs.front().value;
      }
      graph_.stages.push_back(std::move(node));
    }
    reader_ = config_.stages.size();
    for (const char* slot : kOfHost) add(slot, -1, "host");
    for (const StageConfig& sink : config_.sinks) graph_.sinks.push_back(connect(sink));
    // In a program the sinks are not known, which may read what no stage does.
    const bool readers_known = !config_.unclear_names && !config_.in_program;
    if (readers_known) refuse_unread(config_, graph_, open_, problems_);
    return std::move(graph_);
  }

 private:
  /// Possible outputs of a stage of an unknown plugin, from here on.
  void may_make(const std::string& role, const std::string& before) {
    const bool is_open = role.empty() || rules_of(role).is_open;
    vendors_make_more_ = vendors_make_more_ || is_open;
    for (const RoleRules& rules : all_role_rules()) {
      const bool has_choice = !rules.products && rules.part == PipelinePart::stage;
      if (rules.role.name != role && !role.empty() && !(is_open && has_choice)) continue;
      if (rules.products) {
        for (const std::string& slot : *rules.products) perhaps_.insert(before + slot);
        continue;
      }
      for (const RoleSlot& output : rules.main_method().outputs) {
        perhaps_.insert(before + output.name);
      }
    }
  }

  bool may_be_made(const std::string& slot) const {
    const bool is_vendors =
        slot.find('.', slot.starts_with(kPrevious) ? kPrevious.size() : 0) != std::string::npos;
    return perhaps_.count(slot) > 0 || (vendors_make_more_ && is_vendors);
  }

  /// A stage that reads what another one declares otherwise.
  void check_record(const StageConfig& reader, const std::string& slot, int value) {
    const ValueInfo& info = graph_.values[to_index(value)];
    for (const StageConfig& maker : config_.stages) {
      if (info.lag == 0 && maker.name != info.name) continue;
      const std::string wrong = other_record(reader, slot, maker);
      if (!wrong.empty()) return problems_.push_back({reader.at, wrong});
    }
  }

  /// True if `from` has an error, which has been reported.
  static bool has_broken_rule(const StageConfig& stage) {
    return std::any_of(stage.from.begin(), stage.from.end(),
                       [](const FromRule& rule) { return rule.names.empty(); });
  }

  /// True if `from` names an input that the stage does not have: it may mean any.
  static bool has_stray_rule(const StageConfig& stage, const std::vector<Demand>& demands) {
    return std::any_of(stage.from.begin(), stage.from.end(), [&](const FromRule& rule) {
      return std::none_of(demands.begin(), demands.end(),
                          [&](const Demand& demand) { return demand.slot == rule.slot; });
    });
  }

  /// From now on the stage that is being connected may read whatever is made before it.
  void may_read_anything() { open_.before = reader_; }

  int add(const std::string& slot, int stage, const std::string& name, int lag = 0) {
    graph_.values.push_back({slot, stage, name, lag});
    return static_cast<int>(graph_.values.size()) - 1;
  }

  /// Values that exist before the first stage. previous.* is fed back by the host.
  void add_given() {
    std::set<std::string> fed_back;
    for (const RoleSlot& output : rules_of("sources").main_method().outputs) {
      if (!may_enter(config_, output.name)) continue;
      add(output.name, -1, "sources");
      fed_back.insert(output.name);
    }
    add("camera", -1, "sources");
    add("template", -1, "templates");
    for (const StageConfig& stage : config_.stages) {
      const Words made = products_of(stage).value_or(Words{});
      fed_back.insert(made.begin(), made.end());
      if (!products_of(stage)) may_make(stage.role, std::string(kPrevious));
    }
    if (!config_.is_sequence) return;
    for (const std::string& slot : fed_back) add("previous." + slot, -1, "previous", 1);
  }

  Node connect(const StageConfig& stage) {
    Node node;
    if (!is_known(stage.component) || has_broken_rule(stage)) may_read_anything();
    if (stage.role.empty()) return node;
    const std::vector<Demand> demands = demands_of(stage, rules_of(stage).main_method(), problems_);
    check_from(stage, demands);
    for (const Demand& demand : demands) {
      // A stage that also reads other things takes matches as evidence, and the latest are
      // sufficient.
      const bool unites = takes_several(stage, demand.slot) && demands.size() == 1;
      if (unites && chosen(stage, demand.slot) == nullptr && !has_broken_rule(stage)) {
        if (may_be_made(demand.slot) || stage.component.installed == nullptr) continue;
        if (has_stray_rule(stage, demands)) continue;
        problems_.push_back({stage.at, nothing_to_unite(graph_, stage, demand.slot)});
        open_.slots.insert(demand.slot);
        continue;
      }
      const std::vector<int> values = choose(stage, demand.slot);
      for (const int value : values) {
        node.inputs.push_back({demand.slot, value, demand.required});
        check_record(stage, demand.slot, value);
      }
      if (!values.empty() || !demand.required || chosen(stage, demand.slot) != nullptr) continue;
      open_.slots.insert(demand.slot);
      may_read_anything();  // as what is missing may
      if (may_be_made(demand.slot)) continue;
      problems_.push_back({stage.at, missing_input(config_, registry_,
                                                   stage.component.component().id, demand.slot)});
    }
    return node;
  }

  /// The stages on which it depends whether this one is called.
  void find_conditions(const StageConfig& stage, Node& node) {
    if (!stage.when) return;
    if (stage.when->unclear) open_.conditions = true;
    for (const auto& [name, at] : stage.when->not_ok) {
      const std::string mistake = wrong_condition(config_, stage, name);
      if (mistake.empty()) {
        const auto named = [&wanted = name](const StageConfig& other) {
          return other.name == wanted;
        };
        const auto found = std::find_if(config_.stages.begin(), config_.stages.end(), named);
        node.not_ok.push_back(static_cast<int>(found - config_.stages.begin()));
        continue;
      }
      open_.conditions = true;
      if (!is_open(name)) problems_.push_back({at, mistake});
    }
  }

  void check_from(const StageConfig& stage, const std::vector<Demand>& demands) {
    std::vector<std::string> slots;
    for (const Demand& demand : demands) slots.push_back(demand.slot);
    const std::string reader = stage.component.installed != nullptr
                                   ? stage.component.component().id
                                   : "a component of " + stage.role;
    for (const FromRule& rule : stage.from) {
      if (rule.names.empty()) continue;  // reported
      const bool read = contains(slots, rule.slot);
      if (rule.slot == "template_keypoints") {
        problems_.push_back({rule.at, "'from' chooses both kinds of keypoints with: keypoints"});
      } else if (!read) {
        problems_.push_back({rule.at, reader + " does not read " + quote(rule.slot) +
                                          did_you_mean(rule.slot, slots)});
      } else if (rule.names.size() > 1 && !takes_several(stage, rule.slot)) {
        problems_.push_back({rule.at, reader + " takes one '" + rule.slot + "' only"});
      }
      if (read && takes_several(stage, rule.slot)) refuse_twice(rule);
      if (!read) may_read_anything();
    }
  }

  /// A value that is given twice would count twice.
  void refuse_twice(const FromRule& rule) {
    const std::set<std::string> names(rule.names.begin(), rule.names.end());
    if (names.size() == rule.names.size()) return;
    problems_.push_back({rule.at, "'" + rule.slot + "' is taken from one stage twice"});
  }

  static bool takes_several(const StageConfig& stage, const std::string& slot) {
    const RoleRules& rules = rules_of(stage.role);
    return rules.unites && slot == rules.products->front();
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
      // Instead of the previous value a stage may take one of this frame, to refine it.
      const std::string made = made_slot(slot);
      const int value = name.starts_with(kPrevious) ? earlier(*rule, name) : named(made, name);
      if (value >= 0) values.push_back(value);
      if (value >= 0) continue;
      may_read_anything();
      open_.slots.insert(slot);
      if (value != kRefused && slot == rule->slot && !is_open(name)) {
        problems_.push_back({rule->at, wrong_name(config_, graph_, stage, made, name)});
      }
    }
    return values;
  }

  /// True if a name may be that of a stage of an unknown plugin, or of one whose name is not known.
  bool is_open(const std::string& name) const {
    const auto named = [&](const StageConfig& stage) { return stage.name == name; };
    const auto& stages = config_.stages;
    const auto stage = std::find_if(stages.begin(), stages.end(), named);
    if (stage != stages.end()) {
      const bool before = stage - stages.begin() < static_cast<std::ptrdiff_t>(reader_);
      return before && !products_of(*stage);
    }
    const bool unnamed = std::any_of(stages.begin(), stages.end(), [](const StageConfig& each) {
      return each.role.empty() && !each.named;
    });
    const bool known = std::any_of(graph_.values.begin(), graph_.values.end(),
                                   [&](const ValueInfo& value) { return value.name == name; }) ||
                       std::any_of(config_.sinks.begin(), config_.sinks.end(), named);
    return !known && (unnamed || config_.unclear_names);
  }

  /// The value of "previous.TYPE@k", for an input of that type.
  int earlier(const FromRule& rule, const std::string& name) {
    const std::size_t at = std::min(name.find('@'), name.size());
    const std::string slot = name.substr(0, at);
    const std::string type = slot.substr(kPrevious.size());
    if (type != made_slot(rule.slot)) {
      problems_.push_back({rule.at, "'" + rule.slot + "' cannot be read from " + quote(name)});
      return kRefused;
    }
    const auto lag = at == name.size() ? 1 : lag_in(name.substr(at + 1));
    if (!lag) {
      problems_.push_back({rule.at, quote(name) + " must be " + slot + " or " + slot +
                                        "@k, k frames ago, with k from 1 to " +
                                        std::to_string(kLongestLag)});
      return kRefused;
    }
    if (!config_.is_sequence) {
      problems_.push_back({rule.at, without_sequence(quote(name) + " cannot be read")});
      return kRefused;
    }
    if (graph_.latest(slot) < 0 && may_be_made(slot)) return kRefused;
    if (graph_.latest(slot) < 0) {
      problems_.push_back(
          {rule.at, "nothing produces '" + type + "', so that there is no '" + name + "'"});
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
      const ValueInfo& value = graph_.values[to_index(i)];
      if (value.slot == slot && value.name == name) return i;
    }
    return -1;
  }

  const PipelineConfig& config_;
  const host::Registry& registry_;
  std::vector<yaml::Problem>& problems_;
  std::set<std::string> perhaps_;   ///< values that an unknown plugin may have made so far
  bool vendors_make_more_ = false;  ///< likewise, records of vendors
  OpenReading open_;
  std::size_t reader_ = 0;  ///< the stage that is being connected; behind the last for sinks
  Graph graph_;
};

}  // namespace

int Graph::latest(const std::string& slot) const {
  for (int i = static_cast<int>(values.size()) - 1; i >= 0; --i) {
    const ValueInfo& value = values[to_index(i)];
    if (value.slot == slot && value.lag <= 1) return i;
  }
  return -1;
}

Graph wire(const PipelineConfig& config, const host::Registry& registry,
           std::vector<yaml::Problem>& problems) {
  return Wiring(config, registry, problems).wire();
}

}  // namespace weft
