// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "host/calling/execution_context.hpp"

namespace weft::cli {

/// The component that `text` describes, YAML such as {use: templates/frex_sheet}. Relative paths
/// start at the working folder.
Result<host::ComponentSpec> resolve_text(const host::Registry& registry, const std::string& text);

/// The template that a plugin makes of `component`, as above. The record lives as long as it is
/// held.
Result<host::RecordPtr> build_template(const host::Registry& registry,
                                       const std::string& component);

/// A template, checked as before a run.
struct BuiltTemplate {
  host::RecordPtr record;
  std::string note;                  ///< doubts about it; usually empty
  std::vector<std::string> reports;  ///< reports of its component, such as how its image was turned
  std::string size_doubt;            ///< why its size is; mostly empty
};

Result<BuiltTemplate> build_template(const host::ComponentSpec& component);

/// The same component with the mesh of its file, if another mesh is configured: its parameter
/// `vertices` is not 0, the value for the file's mesh.
std::optional<host::ComponentSpec> with_mesh_of_file(const host::Registry& registry,
                                                     const host::ComponentSpec& component);

/// The same component with the output path of this name, which was not given, set; nothing where
/// it has none of that name.
std::optional<host::ComponentSpec> with_output(const host::Registry& registry,
                                               const host::ComponentSpec& component,
                                               const std::string& name, const std::string& path);

}  // namespace weft::cli
