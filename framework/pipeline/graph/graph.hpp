// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pipeline/configuration/config.hpp"

namespace weft {

/// A value that flows through the graph in every frame: an output of the source, the template, the
/// host or a stage.
struct ValueInfo {
  std::string slot;   ///< "image", "correspondences", "previous.shape"
  int stage = -1;     ///< index of the stage that produces it, -1 for source, template and host
  std::string name;   ///< the stage's name, which `from` may choose
  int lag = 0;        ///< [frames] previous values: how long ago
  int filtered = -1;  ///< for a filter: the value whose matches these are, else -1
};

struct InputLink {
  std::string slot;  ///< as the component sees it
  int value;         ///< index into Graph::values
  bool required;
};

/// A stage or sink with what it reads and produces.
struct Node {
  std::vector<InputLink> inputs;  ///< [.] one per slot that is read
  std::vector<int> outputs;       ///< indices into Graph::values
  std::vector<int> not_ok;        ///< indices of the stages that CallRule::not_ok names
};

/// The wired pipeline: stages run in the order of the file, each reading values of earlier ones.
struct Graph {
  std::vector<ValueInfo> values;  ///< [.] indices are used in Node
  std::vector<Node> stages;       ///< [.] in the order of the file
  std::vector<Node> sinks;        ///< [.] in the order of the file

  /// The last value of this slot in the same frame, or for "previous.T" one frame ago; -1 when
  /// there is none.
  int latest(const std::string& slot) const;
};

/// A loaded, wired pipeline: what `weft check` checks and `weft run` runs.
struct CheckedPipeline {
  PipelineConfig config;
  Graph graph;
};

/// Connects all inputs; appends an error for each required input that nothing produces, with the
/// components that could produce it.
Graph wire(const PipelineConfig& config, const host::Registry& registry,
           std::vector<yaml::Problem>& problems);

}  // namespace weft
