// SPDX-License-Identifier: Apache-2.0
#include "pipeline/dumps/replay.hpp"

#include <filesystem>
#include <weft/core/component_id.hpp>
#include <weft/core/shell_word.hpp>
#include <weft/core/suggest.hpp>
#include <weft/core/text_file.hpp>

#include "pipeline/configuration/document_merge.hpp"
#include "pipeline/configuration/output_paths.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;

/// A component as the text of a file or of the command line has it.
Result<host::ComponentSpec> resolve(const host::Registry& registry, const yaml::Node& component,
                                    const std::string& text_name) {
  std::error_code code;
  const std::string here = fs::current_path(code).string();  // dumped paths are absolute
  std::vector<yaml::Problem> problems;
  auto spec = host::resolve_component(registry, *component.find("use"), component.find("params"),
                                      host::PathRules::of_process({here}, here), problems);
  if (spec) {
    if (auto fresh = refuse_existing_outputs(*spec, here); !fresh) return fresh.error();
    return *std::move(spec);
  }
  return Error{Errc::invalid_value, problems.front().message,
               yaml::place(text_name, problems.front().at)};
}

/// The component with other parameters.
Result<yaml::Node> with_params(const yaml::Node& component, const std::string& params) {
  auto document = yaml::parse(params, "--params");
  if (!document) return Error{Errc::invalid_value, document.error().message, "--params"};
  if (!document->problems.empty()) {
    const yaml::Problem& problem = document->problems.front();
    return Error{Errc::invalid_value, problem.message, yaml::place("--params", problem.at)};
  }
  if (document->root.kind != yaml::Kind::map) {
    return Error{Errc::invalid_value, "must be a map, such as \"{alpha_s: 0.2}\"", "--params"};
  }
  yaml::Node over;
  over.kind = yaml::Kind::map;
  over.entries.push_back({"params", {}, std::move(document->root)});
  return merged(component, std::move(over));
}

bool has_dump(const fs::path& folder) {
  std::error_code code;
  return fs::exists(folder / "stage.yaml", code);
}

/// The outcome of a call, with all outputs where they can be compared.
host::Outcome in_host_memory(host::Outcome outcome) {
  for (auto& [slot, record] : outcome.outputs) {
    auto here = record->in_host_memory();
    if (!here) return {WEFT_ERROR, here.error(), {}};
    record = *std::move(here);
  }
  return outcome;
}

}  // namespace

Result<host::Instance*> Replay::make(const DumpedStage& stage, const std::string& name,
                                     host::ComponentSpec spec) {
  specs_.push_back(std::move(spec));
  const auto instance = context_.instantiate(specs_.back(), name);
  if (!instance) return instance.error();
  if (auto ready = context_.prepare(**instance, *stage.templ, *stage.camera); !ready) {
    return ready.error();
  }
  return *instance;
}

Result<std::unique_ptr<Replay>> Replay::create(const host::Registry& registry,
                                               const DumpedStage& stage,
                                               const std::string& params) {
  const std::string file = stage.folder + "/stage.yaml";
  auto spec = resolve(registry, stage.component, file);
  if (!spec) return spec.error();
  if (!params.empty()) {
    const auto changed = with_params(stage.component, params);
    if (!changed) return changed.error();
    spec = resolve(registry, *changed, "--params");
    if (!spec) return spec.error();
  }
  std::unique_ptr<Replay> replay(new Replay(stage.seed));
  replay->is_rebuilt_ = spec->installed->library->build_id != stage.build_id;
  const auto instance = replay->make(stage, stage.name, *std::move(spec));
  if (!instance) return instance.error();
  replay->instance_ = *instance;
  for (const auto& [name, component] : stage.producers) {
    auto producer = resolve(registry, component, file);
    if (!producer) return producer.error();
    const auto made = replay->make(stage, name, *std::move(producer));
    if (!made) return made.error();
    replay->producers_[name] = host::handle_of(**made);
  }
  return replay;
}

Result<void> Replay::check(const StageCall& call) const {
  const host::ComponentManifest& component = specs_.front().component();
  for (const GivenRecord& input : call.inputs) {
    const host::RecordSchema* schema = component.schema_of(input.record->type());
    if (!is_vendor_record(input.record->type())) continue;
    auto valid = schema != nullptr
                     ? host::validate(input.record->view(input.slot.c_str()), *schema)
                     : Error{Errc::invalid_data, component.id + " does not know the record type " +
                                                     std::string(input.record->type()) +
                                                     " of its input '" + input.slot + "'"};
    if (!valid) return valid;
  }
  return {};
}

Replayed Replay::run(const StageCall& call, int repeat) {
  std::vector<weft_record> inputs;
  for (const GivenRecord& input : call.inputs) {
    inputs.push_back(input.record->view(input.slot.c_str()));
    const auto producer = producers_.find(input.producer);
    if (producer != producers_.end()) inputs.back().producer = producer->second;
  }
  Replayed replayed;
  for (int i = 0; i < repeat; ++i) {
    replayed.outcome = in_host_memory(context_.call(*instance_, kRunStage, inputs, call.frame));
    replayed.ms.push_back(context_.times().take().back().took.ms);
    if (replayed.differences.empty()) {
      replayed.differences = differences(call.outcome, replayed.outcome);
    }
  }
  return replayed;
}

Result<std::string> find_dump(const std::string& records, const std::string& stage) {
  std::error_code code;
  fs::path root = fs::absolute(records);
  if (auto found = check_input(records, InputKind::any); !found) {
    return Error{Errc::io, found.error().message, records};
  }
  if (!fs::is_directory(root, code)) root = root.parent_path();
  if (has_dump(root)) {
    const auto found = read_dumped_stage(root.string());
    if (!found) return found.error();
    if (found->name == stage) return root.string();
    return Error{Errc::not_found,
                 "the dump has the stage '" + found->name + "', not '" + stage + "'", records};
  }
  if (fs::is_directory(root / "dumps", code)) root /= "dumps";
  std::vector<std::string> stages;
  for (const auto& entry : fs::directory_iterator(root, code)) {
    if (has_dump(entry.path())) stages.push_back(entry.path().filename().string());
  }
  if (stages.empty()) {
    return Error{Errc::io, "holds no dump; write one with: weft run --dump " + shell_word(stage),
                 records};
  }
  if (has_dump(root / stage)) return (root / stage).string();
  return Error{Errc::not_found,
               "the stage '" + stage + "' was not dumped" + did_you_mean(stage, stages), records};
}

}  // namespace weft
