// SPDX-License-Identifier: Apache-2.0
#include "pipeline/configuration/config.hpp"

#include <algorithm>
#include <tuple>

#include "pipeline/configuration/config_loader.hpp"
#include "pipeline/configuration/inherited_values.hpp"

namespace weft {

std::string ConfigReport::text() const {
  std::string text;
  for (const yaml::Problem& problem : problems) {
    text += place_in(sources, problem.at) + ": " + problem.message + "\n";
  }
  return text;
}

void ConfigReport::sort() {
  const auto key = [](const yaml::Problem& problem) {
    return std::tuple(problem.at.source, problem.at.line, problem.at.column);
  };
  std::stable_sort(problems.begin(), problems.end(),
                   [&](const auto& a, const auto& b) { return key(a) < key(b); });
  // Two inputs that one word chooses are wrong in the same words.
  const auto same = [&](const yaml::Problem& a, const yaml::Problem& b) {
    return key(a) == key(b) && a.message == b.message;
  };
  problems.erase(std::unique(problems.begin(), problems.end(), same), problems.end());
}

Error placed(Error error, const PipelineConfig& config) {
  std::vector<const StageConfig*> stages;
  for (const auto& stage : {&config.source, &config.templ}) {
    if (*stage) stages.push_back(&**stage);
  }
  for (const auto* list : {&config.stages, &config.sinks}) {
    for (const StageConfig& stage : *list) stages.push_back(&stage);
  }
  std::erase_if(stages, [&](const StageConfig* stage) {
    return stage->component.component().id != error.where;
  });
  if (error.subject.empty() || stages.size() != 1) return error;
  if (const auto at = place_of(stages.front()->component, error.subject)) {
    error.where = place_in(config.sources, *at) + ": " + error.where;
  }
  return error;
}

bool has_isolated(const PipelineConfig& config) {
  const auto isolated = [](const auto& stage) { return stage.isolation.has_value(); };
  return (config.source && isolated(*config.source)) || (config.templ && isolated(*config.templ)) ||
         std::any_of(config.stages.begin(), config.stages.end(), isolated) ||
         std::any_of(config.sinks.begin(), config.sinks.end(), isolated);
}

std::pair<PipelineConfig, ConfigReport> load_pipeline(const std::string& file,
                                                      const host::Registry& registry,
                                                      const std::string& output_folder,
                                                      const std::vector<std::string>& settings,
                                                      const std::vector<Patch>& patches) {
  const auto paths = host::PathRules::of_process({}, output_folder);
  return load_pipeline(file, read_document(file, settings, registry, paths, patches), registry,
                       output_folder);
}

std::pair<PipelineConfig, ConfigReport> load_pipeline(const std::string& file,
                                                      PipelineDocument document,
                                                      const host::Registry& registry,
                                                      const std::string& output_folder) {
  auto paths = host::PathRules::of_process({}, output_folder);
  for (const ConfigSource& source : document.sources) paths.input_folders.push_back(source.folder);
  PipelineConfig config;
  config.file = file;
  config.sources = document.sources;
  config.left_out = std::move(document.left_out);
  config.unclear_names = document.unclear_names;
  config.in_program = document.in_program;
  config.given = document.given;
  config.isolating = document.isolating;
  paths.unclear = document.unclear;
  ConfigReport report{document.sources, std::move(document.problems), true, {}};
  const auto of_text = static_cast<std::ptrdiff_t>(report.problems.size());
  // A text that could not be read to its end has no root.
  if (of_text == 0 || document.root.kind == yaml::Kind::map) {
    auto [found, doubts] = check_inherited_values(document, registry, paths);
    for (const host::FormerName& each : document.former_names) {
      doubts.push_back(warning_of(each, document.sources));
    }
    for (const yaml::Problem& doubt : doubts) {
      config.doubts.push_back(place_in(report.sources, doubt.at) + ": " + doubt.message);
    }
    report.warnings = std::move(doubts);
    const bool known = load_config(document.root, registry, paths, config, found);
    report.unclear_stages = !known || document.unclear;
    for (yaml::Problem& mistake : found) {
      const auto end = report.problems.begin() + of_text;
      const bool follows = std::any_of(report.problems.begin(), end,
                                       [&](const auto& other) { return other.at == mistake.at; });
      if (!follows) report.problems.push_back(std::move(mistake));
    }
  }
  report.sort();
  return {std::move(config), std::move(report)};
}

}  // namespace weft
