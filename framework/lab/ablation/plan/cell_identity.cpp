// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/plan/cell_identity.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <weft/core/index.hpp>
#include <weft/core/version.hpp>

#include "host/loading/processor.hpp"
#include "host/records/content_hash.hpp"

namespace weft::lab {

using nlohmann::json;

namespace {

/// The stages that a stage depends on, itself included, as indices; through previous.* too.
std::set<int> closure_of(const Graph& graph, int stage) {
  std::set<int> closure;
  std::vector<int> open{stage};
  while (!open.empty()) {
    const int next = open.back();
    open.pop_back();
    if (!closure.insert(next).second) continue;
    const Node& node = graph.stages[to_index(next)];
    open.insert(open.end(), node.not_ok.begin(), node.not_ok.end());
    for (const InputLink& link : node.inputs) {
      const ValueInfo& value = graph.values[to_index(link.value)];
      if (value.stage >= 0) open.push_back(value.stage);
      if (value.lag == 0) continue;
      for (const ValueInfo& made : graph.values) {
        if (made.stage >= 0 && "previous." + made.slot == value.slot) open.push_back(made.stage);
      }
    }
  }
  return closure;
}

bool is_random(const host::ComponentSpec& spec) {
  return spec.component().random ||
         std::any_of(spec.nested.begin(), spec.nested.end(),
                     [](const host::NestedSpec& nested) { return is_random(nested.component); });
}

/// A plain value with its type, so that 0.2 and 0.20 are one number.
json value_json(const host::ParameterSpec& parameter, const yaml::Node& node) {
  if (node.kind == yaml::Kind::sequence) {
    json list = json::array();
    for (const yaml::Node& item : node.items) list.push_back(value_json(parameter, item));
    return list;
  }
  if (node.kind == yaml::Kind::map) {
    json map = json::object();
    for (const yaml::Entry& entry : node.entries) map[entry.key] = entry.value.scalar;
    return map;
  }
  if (parameter.type == WEFT_VALUE_F64) return yaml::as_double(node).value_or(0.0);
  if (parameter.type == WEFT_VALUE_I64) return yaml::as_int64(node).value_or(0);
  if (parameter.type == WEFT_VALUE_BOOL) return yaml::as_bool(node).value_or(false);
  return node.scalar;
}

void add_input_paths(const host::ComponentSpec& spec, std::vector<std::string>& paths) {
  const yaml::Node* given = spec.effective.find("params");
  for (const host::ParameterSpec& parameter : spec.component().parameters) {
    const yaml::Node* value = given != nullptr ? given->find(parameter.name) : nullptr;
    if (value != nullptr && parameter.names_files(value->scalar)) paths.push_back(value->scalar);
  }
  for (const host::NestedSpec& nested : spec.nested) add_input_paths(nested.component, paths);
}

/// Canonical: members in bytewise order, no spaces.
std::string text_of(const json& identity) {
  return identity.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace

/// The canonical JSON of one cell, with build ids or without.
class IdentityWriter {
 public:
  IdentityWriter(InputFiles& files, const CheckedPipeline& pipeline, std::uint64_t run_seed,
                 bool builds, std::vector<yaml::Problem>& problems)
      : files_(files),
        config_(pipeline.config),
        graph_(pipeline.graph),
        run_seed_(run_seed),
        builds_(builds),
        problems_(problems) {}

  /// Identity of the inputs of the graph.
  json data() {
    const host::ComponentSpec &source = config_.source->component,
                              &templ = config_.templ->component;
    json identity{{"weft", kVersion},
                  {"processor", host::processor_features()},
                  {"source", component(source)},
                  {"template", component(templ)}};
    if (is_random(source) || is_random(templ)) identity["seed"] = run_seed_;
    return identity;
  }

  /// Identity of some of the stages.
  json stages(const std::set<int>& chosen) {
    json list = json::array();
    bool random = false, looks_back = false;
    for (const int index : chosen) {
      const StageConfig& stage = config_.stages[to_index(index)];
      list.push_back(stage_json(stage, graph_.stages[to_index(index)]));
      random = random || is_random(stage.component);
      for (const InputLink& link : graph_.stages[to_index(index)].inputs) {
        const auto value = to_index(link.value);
        looks_back = looks_back || graph_.values[value].slot == "previous.shape";
      }
    }
    json identity{{"stages", std::move(list)}};
    if (random) identity["seed"] = run_seed_;
    if (looks_back) identity["lost_after"] = config_.lost_after;
    return identity;
  }

 private:
  json stage_json(const StageConfig& stage, const Node& node) {
    json inputs = json::array();
    for (const InputLink& link : node.inputs) {
      const ValueInfo& value = graph_.values[to_index(link.value)];
      inputs.push_back({link.slot, value.slot, value.name, value.lag});
    }
    json identity{{"name", stage.name},
                  {"component", component(stage.component)},
                  {"inputs", std::move(inputs)}};
    if (stage.on_template) identity["on_template"] = component(*stage.on_template);
    if (stage.when) {
      json& when = identity["when"] = {{"every", stage.when->every}};
      for (const int other : node.not_ok) {
        when["not_ok"].push_back(config_.stages[to_index(other)].name);
      }
    }
    // Where it runs changes no result, unless it is ended.
    if (stage.isolation && stage.isolation->deadline.count() > 0) {
      identity["deadline_ms"] = stage.isolation->deadline.count();
    }
    return identity;
  }

  json component(const host::ComponentSpec& spec) {
    const host::ComponentManifest& manifest = spec.component();
    json identity{{"id", manifest.id}, {"version", manifest.version}};
    if (builds_) identity["build_id"] = spec.installed->library->build_id;
    json& params = identity["params"] = json::object();
    const yaml::Node* given = spec.effective.find("params");
    for (const host::ParameterSpec& parameter : manifest.parameters) {
      const yaml::Node* value = given != nullptr ? given->find(parameter.name) : nullptr;
      const bool plain =
          parameter.type != WEFT_VALUE_COMPONENT && parameter.type != WEFT_VALUE_OUTPUT_PATH;
      if (value == nullptr || !plain) continue;
      const bool is_word = !value->scalar.empty() && !parameter.names_files(value->scalar);
      params[parameter.name] = parameter.type == WEFT_VALUE_INPUT_PATH && !is_word
                                   ? content_of(*value)
                                   : value_json(parameter, *value);
    }
    for (const auto& [parameter, nested] : spec.nested) params[parameter] = component(nested);
    return identity;
  }

  json content_of(const yaml::Node& path) {
    if (path.scalar.empty()) return nullptr;
    const Result<std::string>& hash = files_.hash_of(path.scalar);
    if (hash) return *hash;
    const std::string& where = hash.error().where;
    problems_.push_back({path.at, (where.empty() ? "" : where + ": ") + hash.error().message});
    return nullptr;
  }

  InputFiles& files_;
  const PipelineConfig& config_;
  const Graph& graph_;
  std::uint64_t run_seed_;
  bool builds_;
  std::vector<yaml::Problem>& problems_;
};

std::vector<std::string> input_paths(const CheckedPipeline& pipeline) {
  const PipelineConfig& config = pipeline.config;
  std::vector<std::string> paths;
  add_input_paths(config.source->component, paths);
  add_input_paths(config.templ->component, paths);
  for (const StageConfig& stage : config.stages) {
    add_input_paths(stage.component, paths);
    if (stage.on_template) add_input_paths(*stage.on_template, paths);
  }
  return paths;
}

IdentityPart Identifier::data_part(const CheckedPipeline& pipeline, std::uint64_t run_seed,
                                   std::vector<yaml::Problem>& problems) {
  std::vector<yaml::Problem> again;  // the same as of the first time
  const json data = IdentityWriter(files_, pipeline, run_seed, true, problems).data();
  const json rebuilt = IdentityWriter(files_, pipeline, run_seed, false, again).data();
  return {text_of(data), text_of(rebuilt), data.contains("seed")};
}

IdentityPart Identifier::rest_part(const CheckedPipeline& pipeline, std::uint64_t run_seed,
                                   const Measurement& measurement,
                                   std::vector<yaml::Problem>& problems) {
  std::set<int> all;
  for (int i = 0; i < static_cast<int>(pipeline.config.stages.size()); ++i) all.insert(i);
  json rest{{"lost_after", pipeline.config.lost_after},
            {"metrics",
             {{"alignment", to_string(measurement.options.alignment)},
              {"match_tolerance_px", measurement.options.match_tolerance_px},
              {"frames", measurement.frames}}}};
  const std::int64_t samples = measurement.options.surface_samples;
  if (samples > 0) rest["metrics"]["surface_samples"] = samples;
  if (!pipeline.config.is_sequence) rest["sequence"] = false;
  // Both decide what is a failure; what they are by default has never been named.
  if (pipeline.config.max_failed > 0) rest["max_failed"] = pipeline.config.max_failed;
  if (pipeline.config.stop_on_error) rest["on_error"] = "stop";
  std::vector<yaml::Problem> again;
  rest["pipeline"] = IdentityWriter(files_, pipeline, run_seed, true, problems).stages(all);
  const bool seeded = rest["pipeline"].contains("seed");
  std::string text = text_of(rest);
  rest["pipeline"] = IdentityWriter(files_, pipeline, run_seed, false, again).stages(all);
  return {std::move(text), text_of(rest), seeded};
}

CellIdentity Identifier::join(const IdentityPart& data, const IdentityPart& rest) {
  // One object: "data" precedes all members of the rest in canonical order.
  const auto whole = [](const std::string& first, const std::string& second) {
    return host::content_hash("{\"data\":" + first + "," + second.substr(1));
  };
  return {whole(data.text, rest.text),
          whole(data.rebuilt, rest.rebuilt),
          host::content_hash(data.text),
          {}};
}

std::vector<std::string> Identifier::stage_keys(const CheckedPipeline& pipeline,
                                                std::uint64_t run_seed) {
  std::vector<yaml::Problem> problems;  // known since the cells were identified
  const std::string group = host::content_hash(data_part(pipeline, run_seed, problems).text);
  IdentityWriter writer(files_, pipeline, run_seed, true, problems);
  std::vector<std::string> keys;
  for (int i = 0; i < static_cast<int>(pipeline.config.stages.size()); ++i) {
    const std::string& name = pipeline.config.stages[to_index(i)].name;
    const json identity{
        {"data", group}, {"stage", name}, {"of", writer.stages(closure_of(pipeline.graph, i))}};
    keys.push_back(host::content_hash(text_of(identity)));
  }
  return keys;
}

CellIdentity Identifier::identify(const CheckedPipeline& pipeline, std::uint64_t run_seed,
                                  const Measurement& measurement,
                                  std::vector<yaml::Problem>& problems) {
  const IdentityPart data = data_part(pipeline, run_seed, problems);
  CellIdentity identity = join(data, rest_part(pipeline, run_seed, measurement, problems));
  identity.stages = stage_keys(pipeline, run_seed);
  return identity;
}

}  // namespace weft::lab
