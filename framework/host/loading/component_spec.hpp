// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/loading/arguments.hpp"
#include "host/loading/registry.hpp"
#include "yaml/yaml.hpp"

namespace weft::host {

/// Where relative paths stand, and what ${NAME} is.
struct PathRules {
  std::vector<std::string> input_folders;  ///< by yaml::Position::source: where that text stands
  std::string output_folder;               ///< the run folder
  std::function<std::optional<std::string>(const std::string&)> variable;
  /// The missing key may be in a file that cannot be read, which has been reported.
  bool unclear = false;

  static PathRules of_process(std::vector<std::string> input_folders, std::string output_folder);
};

struct NestedSpec;

/// A component with its checked parameters, ready to be instantiated.
struct ComponentSpec {
  const Installed* installed = nullptr;  ///< null only in what resolve_known_part gives
  Arguments arguments;
  std::vector<NestedSpec> nested;  ///< [.] its nested components
  yaml::Node effective;            ///< {use, params} with all defaults, paths as they were resolved
  /// The text of secret parameters as written in files, by parameter; see secrets.hpp.
  std::map<std::string, std::string> hidden;
  bool bound = false;  ///< all its own parameters have legal values: it can be created

  const ComponentManifest& component() const { return installed->component; }
};

/// A component that is the value of another one's parameter.
struct NestedSpec {
  std::string parameter;
  ComponentSpec component;
};

/// Checks `use` and `params` (may be null) against what is installed, nested components included.
/// Errors are appended to `problems`; nothing is returned if there are any.
std::optional<ComponentSpec> resolve_component(const Registry& registry, const yaml::Node& use,
                                               const yaml::Node* params, const PathRules& paths,
                                               std::vector<yaml::Problem>& problems);

/// The same for a specification with errors. Returns the known part of the component and of those
/// nested in it; `installed` is null for each unknown one.
ComponentSpec resolve_known_part(const Registry& registry, const yaml::Node& use,
                                 const yaml::Node* params, const PathRules& paths,
                                 std::vector<yaml::Problem>& problems);

/// Where the value of a parameter of the component stands; nothing where it has no such parameter.
std::optional<yaml::Position> place_of(const ComponentSpec& spec, std::string_view parameter);

/// The name of the first parameter that is a length in metres, or an empty text. A component that
/// nests another one of its role leaves the length to that one.
std::string length_parameter(const ComponentSpec& spec);

/// Expands ${NAME} and ${NAME:-default} in a text; the Error names the variable that is not set.
Result<std::string> expand_variables(const std::string& text, const PathRules& paths);

/// The same in a path, and `~/` and `$NAME/` at its beginning.
Result<std::string> expand_path(const std::string& path, const PathRules& paths);

/// The default of an output path, with "{NAME}" as the output path of that name among those given
/// before, without its extension.
std::string default_output(std::string text, const Arguments& given);

/// An output path as the effective configuration has it: relative in the run folder, so that
/// another run writes into its own.
std::string path_in_run(const std::string& path, const PathRules& paths);

}  // namespace weft::host
