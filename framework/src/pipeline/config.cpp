// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <weft/pipeline/config.hpp>

#include "config_loader.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;

/// The place that is part of a syntax error.
yaml::Position position_in(const std::string& where, std::size_t prefix) {
  yaml::Position at;
  std::istringstream place(where.substr(std::min(prefix, where.size())));
  char colon = ':';
  place >> at.line >> colon >> at.column;
  return at;
}

}  // namespace

std::string ConfigReport::text() const {
  std::string text;
  for (const yaml::Problem& problem : problems) {
    text += yaml::place(file, problem.at) + ": " + problem.message + "\n";
  }
  return text;
}

void ConfigReport::sort() {
  std::stable_sort(problems.begin(), problems.end(),
                   [](const yaml::Problem& a, const yaml::Problem& b) {
                     return std::pair(a.at.line, a.at.column) < std::pair(b.at.line, b.at.column);
                   });
}

std::pair<PipelineConfig, ConfigReport> load_pipeline(const std::string& file,
                                                      const host::Registry& registry,
                                                      const std::string& output_folder) {
  PipelineConfig config;
  config.file = file;
  ConfigReport report{file, {}, false};
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();
  if (!stream || fs::is_directory(file)) {
    report.problems.push_back({{}, "the pipeline file cannot be read"});
    return {std::move(config), report};
  }
  auto document = yaml::parse(content.str(), file);
  if (!document) {
    report.problems.push_back(
        {position_in(document.error().where, file.size() + 1), document.error().message});
    return {std::move(config), report};
  }
  report.problems = std::move(document->problems);
  const std::size_t of_text = report.problems.size();
  // A text that could not be read to its end has no root.
  if (of_text == 0 || document->root.kind == yaml::Kind::map) {
    const std::string folder = fs::absolute(file).parent_path().string();
    std::vector<yaml::Problem> found;
    const auto paths = host::PathRules::of_process(folder, output_folder);
    const bool complete = load_config(document->root, registry, paths, config, found);
    report.wirable = of_text == 0 && complete;
    for (yaml::Problem& mistake : found) {
      const auto end = report.problems.begin() + static_cast<std::ptrdiff_t>(of_text);
      const bool follows = std::any_of(report.problems.begin(), end,
                                       [&](const auto& other) { return other.at == mistake.at; });
      if (!follows) report.problems.push_back(std::move(mistake));
    }
  }
  report.sort();
  return {std::move(config), report};
}

}  // namespace weft
