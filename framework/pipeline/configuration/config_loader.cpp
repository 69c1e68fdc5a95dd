// SPDX-License-Identifier: Apache-2.0
#include "pipeline/configuration/config_loader.hpp"

#include <algorithm>
#include <set>
#include <weft/core/quote.hpp>
#include <weft/core/suggest.hpp>

#include "host/roles/role_rules.hpp"
#include "pipeline/configuration/isolation_rules.hpp"
#include "pipeline/configuration/pipeline_keys.hpp"
#include "pipeline/configuration/words.hpp"
#include "yaml/keys.hpp"

namespace weft {
namespace {

class Loader {
 public:
  Loader(const host::Registry& registry, host::PathRules paths, PipelineConfig& config,
         std::vector<yaml::Problem>& problems)
      : registry_(registry), paths_(std::move(paths)), config_(config), problems_(problems) {}

  void load(const yaml::Node& given) {
    if (given.kind != yaml::Kind::map) {
      unclear_stages_ = true;
      return problem(given.at, "a pipeline is a map with the keys weft, source, template, stages");
    }
    const yaml::Node root = with_keys_of(given, "a pipeline", pipeline_keys());
    check_version(root);
    read_options(root);
    if (!config_.in_program) {
      config_.source = read_single(root, "source", PipelinePart::source);
    }
    config_.templ = read_single(root, "template", PipelinePart::templ);
    read_list(root, "stages", config_.stages, PipelinePart::stage);
    if (config_.in_program) return;
    read_list(root, "sinks", config_.sinks, PipelinePart::sink);
  }

  bool unclear_stages() const { return unclear_stages_; }

 private:
  void problem(yaml::Position at, std::string message) {
    problems_.push_back({at, std::move(message)});
  }

  yaml::Node with_keys_of(yaml::Node node, const std::string& what, const yaml::KeyTable& table) {
    const Words keys = yaml::names_of(table);
    yaml::correct_keys(node, keys, [&](const yaml::Entry& entry, const std::string& near) {
      problem(entry.at, what + " has no key " + quote(entry.key) +
                            meant(near, "; it may have: " + joined(keys)));
    });
    return node;
  }

  void check_version(const yaml::Node& root) {
    const yaml::Node* version = root.find("weft");
    if (version == nullptr && paths_.unclear) return;
    if (version == nullptr) {
      problem(root.at, "the key 'weft' is missing; begin the file with: weft: 1");
    } else if (yaml::as_int64(*version) != 1) {
      problem(version->at, "'weft' must be 1, the version of the pipeline format");
    }
  }

  void read_integer(const yaml::Node& map, const yaml::Key& key, std::int64_t& target) {
    const yaml::Node* node = map.find(key.name);
    if (node == nullptr) return;
    const auto number = yaml::as_int64(*node);
    if (number && *number >= key.low && *number <= key.high) {
      target = *number;
    } else {
      problem(node->at, "'" + key.name + "' must be a whole number from " +
                            std::to_string(key.low) + " to " + std::to_string(key.high));
    }
  }

  void read_options(const yaml::Node& root) {
    std::int64_t seed = 0, lost_after = config_.lost_after, max_failed = config_.max_failed;
    std::int64_t frames_at_once = config_.frames_at_once, threads = config_.threads;
    std::int64_t budget_ms = config_.budget_ms;
    const auto read = [&](const char* name, std::int64_t& target) {
      read_integer(root, yaml::key_of(pipeline_keys(), name), target);
    };
    read("seed", seed);
    read("lost_after", lost_after);
    read("max_failed", max_failed);
    read("frames_at_once", frames_at_once);
    read("threads", threads);
    read("budget_ms", budget_ms);
    config_.seed = static_cast<std::uint64_t>(seed);
    config_.lost_after = static_cast<int>(lost_after);
    config_.max_failed = static_cast<int>(max_failed);
    config_.frames_at_once = static_cast<int>(frames_at_once);
    config_.threads = static_cast<int>(threads);
    config_.budget_ms = static_cast<int>(budget_ms);
    config_.stop_on_error = is_chosen(root, "on_error", "stop");
    config_.latest_only = is_chosen(root, "realtime", "latest");
    config_.is_sequence = read_flag(root, "sequence", config_.is_sequence);
  }

  /// The value of a key; `otherwise` if it is not legal, so that no further error follows.
  bool read_flag(const yaml::Node& map, const char* name, bool otherwise) {
    const yaml::Node* given = map.find(name);
    if (given == nullptr) return otherwise;
    const auto flag = yaml::as_bool(*given);
    if (!flag) problem(given->at, std::string("'") + name + "' must be true or false");
    return flag.value_or(otherwise);
  }

  /// True if a key has this one of its values.
  bool is_chosen(const yaml::Node& root, const char* name, const std::string& choice) {
    const yaml::Node* node = root.find(name);
    if (node == nullptr) return false;
    const Words& choices = yaml::key_of(pipeline_keys(), name).choices;
    if (!contains(choices, node->scalar)) {
      problem(node->at, std::string("'") + name + "' must be one of: " + joined(choices));
    }
    return node->scalar == choice;
  }

  std::optional<StageConfig> read_single(const yaml::Node& root, const char* key,
                                         PipelinePart part) {
    const Place& place = place_of(part);
    const yaml::Node* node = root.find(key);
    if (node == nullptr) {
      if (!paths_.unclear) problem(root.at, std::string("the key '") + key + "' is missing");
      return std::nullopt;
    }
    const yaml::Node item = with_keys_of(*node, place.what, place.keys);
    StageConfig stage = read_component(item, place);
    stage.name = place.roles.front();
    if (root.find_entry(key)->unclear) stage.component = {};
    read_isolation(item, part, stage);
    return stage;
  }

  /// One component; parts that it lacks have been reported.
  StageConfig read_component(const yaml::Node& node, const Place& place) {
    StageConfig stage;
    stage.at = node.at;
    if (node.kind != yaml::Kind::map) {
      problem(node.at, place.what + " must be a component, such as {use: " + place.roles.back() +
                           "/..., params: {...}}");
      return stage;
    }
    read_overwrite(node, stage);
    const yaml::Entry* use = node.find_entry("use");
    if (use == nullptr) {
      if (!node.unclear && !paths_.unclear) {
        problem(node.at, place.what + " lacks the key 'use'");
      }
      return stage;
    }
    if (use->unclear) return stage;
    stage.component = resolve(node);
    const std::string role = role_meant(use->value.scalar);
    if (contains(place.roles, role)) {
      stage.role = role;
    } else if (stage.component.installed != nullptr) {
      stage.component = {};
      problem(use->value.at, quote(use->value.scalar) + " cannot be " + place.what +
                                 "; legal roles: " + joined(place.roles));
    }
    return stage;
  }

  void read_overwrite(const yaml::Node& node, StageConfig& stage) {
    // A value that is no flag counts as true, because errors without the flag would only be
    // consequences.
    stage.overwrite = node.find("overwrite") != nullptr && read_flag(node, "overwrite", true);
  }

  /// The known facts about the component in `node`, which has a `use`.
  host::ComponentSpec resolve(const yaml::Node& node) {
    const yaml::Entry* given = node.find_entry("params");
    yaml::Node params = given != nullptr ? given->value : yaml::Node{};
    params.unclear = params.unclear || node.unclear || (given != nullptr && given->unclear);
    const bool present = given != nullptr || params.unclear;
    if (given == nullptr) params.at = node.find("use")->at;
    return host::resolve_known_part(registry_, *node.find("use"), present ? &params : nullptr,
                                    paths_, problems_);
  }

  void read_list(const yaml::Node& root, const char* key, std::vector<StageConfig>& stages,
                 PipelinePart part) {
    const Place& place = place_of(part);
    const yaml::Node* list = root.find(key);
    if (list == nullptr || yaml::is_null(*list)) return;
    if (root.find_entry(key)->unclear) unclear_stages_ = true;
    if (list->kind != yaml::Kind::sequence) {
      unclear_stages_ = true;
      return problem(list->at, std::string("'") + key +
                                   "' must be a list, each item beginning with '- use: '");
    }
    yaml::Node corrected = *list;
    for (yaml::Node& item : corrected.items) {
      item = with_keys_of(std::move(item), place.what, place.keys);
    }
    const std::vector<std::string> names = names_of_stages(corrected);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const yaml::Node& item = corrected.items[i];
      StageConfig stage = read_component(item, place);
      stage.name = names[i];
      read_name(item, stage);
      if (item.unclear) config_.unclear_names = true;
      read_from(item, stage);
      read_isolation(item, part, stage);
      read_when(item, stage);
      if (stage.component.installed != nullptr) read_template_params(item, stage);
      stages.push_back(std::move(stage));
    }
  }

  void read_name(const yaml::Node& item, StageConfig& stage) {
    const yaml::Node* as = item.find("as");
    if (as == nullptr) return;
    if (item.find_entry("as")->unclear) config_.unclear_names = true;
    const auto legal = [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    };
    const std::string& name = as->scalar;
    if (name.empty() || !std::all_of(name.begin(), name.end(), legal)) {
      config_.unclear_names = true;
      return problem(as->at, "'as' must be a name of a-z, 0-9 and _");
    }
    // Without its base, whose error is reported, an item may be a change of one of its stages.
    if (paths_.unclear && item.find("use") == nullptr) return;
    if (contains(reserved_names(), name)) {
      config_.unclear_names = true;
      problem(as->at, "'as' must not be '" + name + "', which is a reserved name");
    } else if (!names_.insert(name).second) {
      problem(as->at, "the name " + quote(name) + " is used twice");
    }
    stage.named = true;
  }

  void read_from(const yaml::Node& item, StageConfig& stage) {
    const yaml::Node* from = item.find("from");
    if (from == nullptr) return;
    if (item.find_entry("from")->unclear || from->unclear) stage.from.push_back({"", {}, from->at});
    if (from->kind != yaml::Kind::map) {
      stage.from.push_back({"", {}, from->at});
      return problem(from->at, "'from' must be a map of inputs and names, such as {warp: NAME}");
    }
    for (const yaml::Entry& entry : from->entries) {
      FromRule rule{entry.key, {}, entry.at};
      const bool is_list = entry.value.kind == yaml::Kind::sequence;
      const std::vector<yaml::Node> names =
          is_list ? entry.value.items : std::vector<yaml::Node>{entry.value};
      for (const yaml::Node& name : names) {
        if (name.kind == yaml::Kind::scalar) rule.names.push_back(name.scalar);
      }
      if (names.empty() || rule.names.size() < names.size()) {
        problem(entry.value.at,
                quote(entry.key) + " must be the name of a stage, or a list of names");
        rule.names.clear();
      }
      if (entry.unclear) rule.names.clear();
      stage.from.push_back(std::move(rule));
    }
  }

  /// The choice of the pipeline, else that of `config_.isolating`.
  void read_isolation(const yaml::Node& item, PipelinePart part, StageConfig& stage) {
    const yaml::Node* isolate = item.find("isolate");
    const yaml::Node* deadline = item.find("deadline_ms");
    const bool stays = isolate != nullptr && isolate->scalar == "none";
    const bool goes = isolate != nullptr && isolate->scalar == "process";
    if (isolate != nullptr && !stays && !goes) {
      problem(isolate->at, "'isolate' must be process, or none to run it in here");
    }
    const IsolationRules rules(stage.component, part, config_.isolating);
    if (goes && !rules.bound_by().empty()) {
      problem(isolate->at, "'isolate' cannot be process: " + rules.bound_by());
    }
    stage.isolated_by_default = isolate == nullptr && rules.is_wanted();
    if (goes || stage.isolated_by_default) stage.isolation.emplace();
    stage.stays_here = !stage.isolation && rules.has_reason();
    if (deadline != nullptr && goes) {
      std::int64_t deadline_ms = 0;
      read_integer(item, yaml::key_of(place_of(part).keys, "deadline_ms"), deadline_ms);
      stage.isolation->deadline = std::chrono::milliseconds(deadline_ms);
    } else if (deadline != nullptr && (isolate != nullptr || !may_be_said_elsewhere(item))) {
      problem(deadline->at, "'deadline_ms' needs 'isolate: process': only a process can be ended");
    }
    if (stage.isolation) stage.isolation->keeps_spare = config_.latest_only;
  }

  bool may_be_said_elsewhere(const yaml::Node& item) const {
    return item.unclear || paths_.unclear;
  }

  void read_when(const yaml::Node& item, StageConfig& stage) {
    const yaml::Entry* given = item.find_entry("when");
    if (given == nullptr) return;
    CallRule& rule = stage.when.emplace();
    rule.unclear = given->unclear || given->value.unclear;
    const std::size_t before = problems_.size();
    const yaml::Node when = with_keys_of(given->value, "'when'", condition_keys());
    if (when.kind != yaml::Kind::map) {
      problem(when.at, "'when' must be a map, such as {not_ok: NAME, every: 30}");
    } else if (when.entries.empty() && !rule.unclear) {
      problem(when.at, "'when' is empty; give it not_ok: NAME, every: N or both");
    }
    read_integer(when, yaml::key_of(condition_keys(), "every"), rule.every);
    if (const yaml::Node* not_ok = when.find("not_ok")) {
      const bool is_list = not_ok->kind == yaml::Kind::sequence;
      const std::vector<yaml::Node> names =
          is_list ? not_ok->items : std::vector<yaml::Node>{*not_ok};
      for (const yaml::Node& name : names) {
        if (name.kind == yaml::Kind::scalar) rule.not_ok.push_back({name.scalar, name.at});
      }
      if (names.empty() || rule.not_ok.size() < names.size()) {
        problem(not_ok->at, "'not_ok' must be the name of a stage, or a list of names");
      }
    }
    rule.unclear = rule.unclear || problems_.size() > before;
  }

  void read_template_params(const yaml::Node& item, StageConfig& stage) {
    const yaml::Node* overrides = item.find("template_params");
    if (overrides == nullptr) return;
    const bool unclear = item.unclear || item.find_entry("template_params")->unclear;
    if (!rules_of(stage.role).sees_texture) {
      return problem(overrides->at, "only detectors have template_params");
    }
    if (overrides->kind != yaml::Kind::map) {
      return problem(overrides->at, "template_params must be a map of names and values");
    }
    yaml::Node merged = *overrides;
    merged.unclear = merged.unclear || unclear;
    if (const yaml::Node* params = item.find("params")) {
      merged.unclear = merged.unclear || params->unclear || item.find_entry("params")->unclear;
      for (const yaml::Entry& entry : params->entries) {
        if (merged.find(entry.key) == nullptr) merged.entries.push_back(entry);
      }
    }
    std::vector<yaml::Problem> found;
    stage.on_template =
        host::resolve_component(registry_, *item.find("use"), &merged, paths_, found);
    // An error in params has been reported already.
    for (yaml::Problem& mistake : found) {
      const bool known =
          std::any_of(problems_.begin(), problems_.end(),
                      [&](const yaml::Problem& other) { return other.at == mistake.at; });
      if (!known) problems_.push_back(std::move(mistake));
    }
  }

  const host::Registry& registry_;
  host::PathRules paths_;
  PipelineConfig& config_;
  std::vector<yaml::Problem>& problems_;
  std::set<std::string> names_;
  bool unclear_stages_ = false;
};

}  // namespace

bool load_config(const yaml::Node& root, const host::Registry& registry,
                 const host::PathRules& paths, PipelineConfig& config,
                 std::vector<yaml::Problem>& problems) {
  Loader loader(registry, paths, config, problems);
  loader.load(root);
  return !loader.unclear_stages();
}

}  // namespace weft
