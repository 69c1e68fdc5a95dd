// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/roles/role_rules.hpp"
#include "pipeline/configuration/words.hpp"
#include "pipeline/graph/graph.hpp"

namespace weft {

/// The values that a component adds to the graph. Sources and passes have a choice and declare it.
std::vector<std::string> products_of(const host::ComponentManifest& component);

/// The same for a stage, as far as its role alone determines it if the plugin is unknown.
std::optional<Words> products_of(const StageConfig& stage);

/// How the host treats its role, with its component's own slots if the role leaves them open.
const RoleRules& rules_of(const StageConfig& stage);

/// True if the plugin and all that are nested in it are known.
bool is_known(const host::ComponentSpec& spec);

/// An input of a component: `required` or used when present.
struct Demand {
  std::string slot;
  bool required;
};

/// The inputs that the component of a stage and those nested in it use.
std::vector<Demand> demands_of(const StageConfig& stage, const RoleMethod& offered,
                               std::vector<yaml::Problem>& problems);

/// The parts of the graph that an error makes unknown, so that mere consequences are not reported.
struct OpenReading {
  std::set<std::string> slots;        ///< some stage may be meant to read any value of these
  std::optional<std::size_t> before;  ///< and some may read anything that is made before this stage
  bool conditions = false;            ///< any stage may be one that another one's `when` names
};

/// Message about a missing required input: why, and what could produce it.
std::string missing_input(const PipelineConfig& config, const host::Registry& registry,
                          const std::string& id, const std::string& slot);

/// That something of the frame before is not there, because frames are no sequence.
std::string without_sequence(const std::string& what);

/// Why `reader` cannot take `slot` from `name`; `graph` has the stages before it.
std::string wrong_name(const PipelineConfig& config, const Graph& graph, const StageConfig& reader,
                       const std::string& slot, const std::string& name);

/// Why `reader` cannot read a vendor's record from `maker`: another version of its type, or another
/// declaration of it. Empty where it can, and of the catalogue's types.
std::string other_record(const StageConfig& reader, const std::string& slot,
                         const StageConfig& maker);

/// Why `reader` cannot use the outcome of the stage `name`; empty if it can.
std::string wrong_condition(const PipelineConfig& config, const StageConfig& reader,
                            const std::string& name);

/// That `reader`, which unites several values of `slot`, is given at most the latest.
std::string nothing_to_unite(const Graph& graph, const StageConfig& reader,
                             const std::string& slot);

/// Appends an error for each stage whose work is lost, in a pipeline that makes a shape. A pipeline
/// without a solver exists for its stages: their outputs are recorded and measured.
void refuse_unread(const PipelineConfig& config, const Graph& graph, const OpenReading& open,
                   std::vector<yaml::Problem>& problems);

}  // namespace weft
