// SPDX-License-Identifier: Apache-2.0
#include "host/loading/secrets.hpp"
#include "pipeline/configuration/config.hpp"

namespace weft {
namespace {

yaml::Node list_of(const std::vector<std::string>& names) {
  yaml::Node list;
  list.kind = yaml::Kind::sequence;
  for (const std::string& name : names) list.items.push_back(yaml::text_node(name));
  return list;
}

yaml::Node effective_rule(const CallRule& rule) {
  yaml::Node when;
  when.kind = yaml::Kind::map;
  if (!rule.not_ok.empty()) {
    std::vector<std::string> names;
    for (const CallRule::Name& stage : rule.not_ok) names.push_back(stage.name);
    when.entries.push_back({"not_ok", {}, list_of(names)});
  }
  if (rule.every > 0) {
    when.entries.push_back({"every", {}, yaml::plain_node(std::to_string(rule.every))});
  }
  return when;
}

yaml::Node effective_stage(const StageConfig& stage, Secrets secrets) {
  const auto written = [secrets](const host::ComponentSpec& spec) {
    return secrets == Secrets::hidden ? host::without_secrets(spec) : spec.effective;
  };
  yaml::Node node = written(stage.component);
  if (stage.named) node.entries.push_back({"as", {}, yaml::text_node(stage.name)});
  if (!stage.from.empty()) {
    yaml::Node from;
    from.kind = yaml::Kind::map;
    for (const FromRule& rule : stage.from) {
      const yaml::Node names = list_of(rule.names);
      from.entries.push_back({rule.slot, {}, rule.names.size() == 1 ? names.items[0] : names});
    }
    node.entries.push_back({"from", {}, from});
  }
  if (stage.when) node.entries.push_back({"when", {}, effective_rule(*stage.when)});
  if (stage.on_template) {
    node.entries.push_back({"template_params", {}, *written(*stage.on_template).find("params")});
  }
  if (stage.overwrite) node.entries.push_back({"overwrite", {}, yaml::plain_node("true")});
  if (stage.stays_here) node.entries.push_back({"isolate", {}, yaml::plain_node("none")});
  if (stage.isolation) {
    node.entries.push_back({"isolate", {}, yaml::plain_node("process")});
    const auto deadline_ms = stage.isolation->deadline.count();
    if (deadline_ms > 0) {
      node.entries.push_back({"deadline_ms", {}, yaml::plain_node(std::to_string(deadline_ms))});
    }
  }
  return node;
}

}  // namespace

std::string effective_yaml(const PipelineConfig& config, Secrets secrets) {
  yaml::Node root;
  root.kind = yaml::Kind::map;
  const auto add = [&](const char* key, yaml::Node node) {
    root.entries.push_back({key, {}, std::move(node)});
  };
  const auto list = [secrets](const std::vector<StageConfig>& stages) {
    yaml::Node node;
    node.kind = yaml::Kind::sequence;
    for (const StageConfig& stage : stages) node.items.push_back(effective_stage(stage, secrets));
    return node;
  };
  add("weft", yaml::plain_node("1"));
  add("seed", yaml::plain_node(std::to_string(config.seed)));
  add("lost_after", yaml::plain_node(std::to_string(config.lost_after)));
  add("on_error", yaml::plain_node(config.stop_on_error ? "stop" : "continue"));
  add("max_failed", yaml::plain_node(std::to_string(config.max_failed)));
  // Settings that do not change results are listed only if they differ from the default.
  const PipelineConfig untouched;
  for (const auto& [key, value, usual] :
       {std::tuple{"frames_at_once", config.frames_at_once, untouched.frames_at_once},
        {"threads", config.threads, untouched.threads}}) {
    if (value != usual) add(key, yaml::plain_node(std::to_string(value)));
  }
  if (config.budget_ms != untouched.budget_ms) {
    add("budget_ms", yaml::plain_node(std::to_string(config.budget_ms)));
  }
  if (config.latest_only) add("realtime", yaml::plain_node("latest"));
  if (!config.is_sequence) add("sequence", yaml::plain_node("false"));
  add("source", effective_stage(*config.source, secrets));
  add("template", effective_stage(*config.templ, secrets));
  add("stages", list(config.stages));
  add("sinks", list(config.sinks));
  return yaml::emit(root);
}

}  // namespace weft
