// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/pipeline/graph.hpp>

namespace weft {

using Words = std::vector<std::string>;

bool contains(const Words& words, const std::string& word);

/// "a, b, c".
std::string joined(const Words& words);

/// The values that a component adds to the graph. Sources and passes have a choice and say it.
std::vector<std::string> products_of(const host::ComponentManifest& component);

/// That a required input is missing, why, and what could produce it.
std::string missing_input(const PipelineConfig& config, const host::Registry& registry,
                          const std::string& id, const std::string& slot);

/// Why `reader` cannot take `slot` from `name`; `graph` holds what stands before it.
std::string wrong_name(const PipelineConfig& config, const Graph& graph, const StageConfig& reader,
                       const std::string& slot, const std::string& name);

/// That `reader`, which unites several values of `slot`, is given at most the latest.
std::string nothing_to_unite(const Graph& graph, const StageConfig& reader,
                             const std::string& slot);

/// Appends a mistake for each stage whose work is lost, in a pipeline that makes a shape. Without a
/// solver a pipeline is there for its stages: what they make is recorded and measured.
void refuse_unread(const PipelineConfig& config, const Graph& graph,
                   std::vector<yaml::Problem>& problems);

}  // namespace weft
