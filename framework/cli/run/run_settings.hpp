// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "pipeline/configuration/config.hpp"

namespace weft::cli {

/// The option --set of commands that take a pipeline.
void add_settings(CLI::App& command, std::vector<std::string>& settings);

/// The option --without of commands that take a plan.
void add_without(CLI::App& command, std::vector<std::string>& names);

/// The option --isolate of commands that run pipelines; `choice` is a word of it.
void add_isolation(CLI::App& command, std::string& choice);
Isolating isolating_of(const std::string& choice);

/// "filters/mine runs in a separate process (--isolate none runs it here)", for components without
/// a setting in the pipeline; empty if there are none.
std::string words_on_isolation(const PipelineConfig& config);

/// The run folder of a pipeline for which none is given: runs/<pipeline>, or the first of
/// runs/<pipeline>-2, -3 ... that does not exist.
std::string free_folder(const std::string& pipeline);

/// `folder`, or the first of folder-2, folder-3 ... that does not exist.
std::string free_beside(const std::string& folder);

/// A folder that this process alone has made. It is removed at the end, with `runs` where that is
/// new too, unless something is in it.
class ClaimedFolder {
 public:
  ClaimedFolder() = default;
  ClaimedFolder(const ClaimedFolder&) = delete;
  ClaimedFolder& operator=(const ClaimedFolder&) = delete;
  ~ClaimedFolder();

  /// False where another process was first. A folder that cannot be made counts as claimed: the run
  /// reports the reason.
  bool take(const std::string& folder);

 private:
  std::vector<std::string> made_;  ///< the innermost first
};

}  // namespace weft::cli
