// SPDX-License-Identifier: Apache-2.0
#include "pipeline/configuration/declared_paths.hpp"

#include <algorithm>

namespace weft {
namespace {

namespace fs = std::filesystem;

/// Without the slash at its end, by which a folder may be spelt.
fs::path without_end(fs::path path) {
  path = path.lexically_normal();
  return path.has_filename() || path == path.root_path() ? path : path.parent_path();
}

void add_declared(const host::ComponentSpec& spec, weft_value_type type, const std::string& folder,
                  const std::string& prefix, std::vector<DeclaredPath>& found) {
  const yaml::Node* params = spec.effective.find("params");
  if (spec.installed == nullptr || params == nullptr) return;  // an error that was reported
  for (const host::ParameterSpec& parameter : spec.component().parameters) {
    const yaml::Node* value = params->find(parameter.name);
    if (parameter.type != type || value == nullptr || value->scalar.empty()) continue;
    if (type == WEFT_VALUE_INPUT_PATH && !parameter.names_files(value->scalar)) continue;
    found.push_back({prefix + parameter.name, spec.component().id,
                     without_end(fs::path(folder) / value->scalar), value->at});
  }
  for (const host::NestedSpec& nested : spec.nested) {
    add_declared(nested.component, type, folder, prefix + nested.parameter + ".", found);
  }
}

}  // namespace

std::vector<DeclaredPath> declared_paths(const host::ComponentSpec& component, weft_value_type type,
                                         const std::string& folder) {
  std::vector<DeclaredPath> found;
  add_declared(component, type, folder, "", found);
  return found;
}

std::vector<DeclaredPath> declared_paths(const PipelineConfig& config, weft_value_type type,
                                         const std::string& folder) {
  std::vector<const StageConfig*> entries;
  if (config.source) entries.push_back(&*config.source);
  if (config.templ) entries.push_back(&*config.templ);
  for (const auto* list : {&config.stages, &config.sinks}) {
    for (const StageConfig& stage : *list) entries.push_back(&stage);
  }
  std::vector<DeclaredPath> all;
  for (const StageConfig* entry : entries) {
    std::vector<DeclaredPath> own = declared_paths(entry->component, type, folder);
    if (entry->on_template) {
      // Where template_params leave a path as it is, the detector writes it once.
      for (DeclaredPath& path : declared_paths(*entry->on_template, type, folder)) {
        const bool same = std::any_of(own.begin(), own.end(), [&](const DeclaredPath& other) {
          return other.path == path.path;
        });
        if (!same) own.push_back(std::move(path));
      }
    }
    for (DeclaredPath& path : own) {
      path.overwrite = entry->overwrite;
      all.push_back(std::move(path));
    }
  }
  return all;
}

}  // namespace weft
