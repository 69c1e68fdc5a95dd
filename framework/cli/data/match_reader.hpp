// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "cli/data/match_writer.hpp"
#include "host/loading/registry.hpp"
#include "yaml/yaml.hpp"

namespace weft::cli {

/// Where matches are read.
struct MatchOrigin {
  std::string path;
  std::string camera;                 ///< file, where none lies beside the matches; or empty
  std::string stage;                  ///< stage of a run folder; empty if only one stage has
                                      ///< matches
  std::vector<std::string> settings;  ///< settings of a pipeline
  double tolerance_px = 2.0;          ///< for labels that follow from the truth
};

/// Writes the matches of a run folder, of a pipeline's source, or of a set of files. For matches of
/// a run, labels from its truth are added. Returns the pipeline's template, or null.
Result<yaml::Node> read_matches(const MatchOrigin& origin, const host::Registry& registry,
                                const std::atomic<bool>& cancel, MatchWriter& writer);

}  // namespace weft::cli
