// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "pipeline/configuration/output_paths.hpp"
#include "pipeline/runs/run.hpp"

namespace weft {
namespace {

/// Parameter checks of the components whose parameters are legal. A component with its own process
/// is not checked: nothing loads its library in this one.
void ask_components(const PipelineConfig& config, host::ComponentChecks& checks,
                    ConfigReport& report) {
  std::vector<yaml::Problem> found;
  const auto ask = [&](const host::ComponentSpec& component) {
    checks.ask(component, found, &report.warnings);
  };
  for (const auto* single : {&config.source, &config.templ}) {
    if (*single && !(*single)->isolation) ask((*single)->component);
  }
  for (const auto* list : {&config.stages, &config.sinks}) {
    for (const StageConfig& stage : *list) {
      if (stage.isolation) continue;
      ask(stage.component);
      if (stage.on_template) ask(*stage.on_template);
    }
  }
  for (yaml::Problem& mistake : found) {
    const auto same = [&](const yaml::Problem& other) {
      return other.at == mistake.at && other.message == mistake.message;
    };
    if (std::any_of(report.problems.begin(), report.problems.end(), same)) continue;
    report.problems.push_back(std::move(mistake));
  }
}

}  // namespace

std::pair<CheckedPipeline, ConfigReport> check_pipeline(const std::string& file,
                                                        const host::Registry& registry,
                                                        const std::string& output_folder,
                                                        const std::vector<std::string>& settings,
                                                        const std::vector<Patch>& patches,
                                                        host::ComponentChecks* checks) {
  const auto paths = host::PathRules::of_process({}, output_folder);
  return check_pipeline(file, read_document(file, settings, registry, paths, patches), registry,
                        output_folder, checks);
}

std::pair<CheckedPipeline, ConfigReport> check_pipeline(const std::string& file,
                                                        PipelineDocument document,
                                                        const host::Registry& registry,
                                                        const std::string& output_folder,
                                                        host::ComponentChecks* checks) {
  auto [config, report] = load_pipeline(file, std::move(document), registry, output_folder);
  CheckedPipeline pipeline{std::move(config), {}};
  refuse_unsafe_outputs(pipeline.config, registry, output_folder, report.problems);
  host::ComponentChecks own;
  ask_components(pipeline.config, checks != nullptr ? *checks : own, report);
  if (!report.unclear_stages) pipeline.graph = wire(pipeline.config, registry, report.problems);
  report.sort();
  return {std::move(pipeline), std::move(report)};
}

Result<CheckedPipeline> check_change(const PipelineConfig& running, const std::string& folder,
                                     const host::Registry& registry,
                                     const std::vector<std::string>& settings) {
  const std::string file = folder + "/pipeline.yaml";
  // The file itself has no secrets.
  auto text = yaml::parse(effective_yaml(running, Secrets::shown), file);
  if (!text) return text.error();
  PipelineDocument document;
  document.root = std::move(text->root);
  document.sources = {{file, folder}};
  document = laid_over(std::move(document), {}, settings, registry,
                       host::PathRules::of_process({}, folder));
  auto [config, report] = load_pipeline(file, std::move(document), registry, folder);
  CheckedPipeline pipeline{std::move(config), {}};
  host::ComponentChecks checks;
  ask_components(pipeline.config, checks, report);
  if (!report.unclear_stages) pipeline.graph = wire(pipeline.config, registry, report.problems);
  report.sort();
  if (report.ok()) return pipeline;
  return Error{Errc::invalid_value, report.problems.front().message};
}

}  // namespace weft
