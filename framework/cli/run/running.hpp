// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "pipeline/configuration/config.hpp"

namespace weft::cli {

struct RunArguments {
  std::string pipeline;
  std::string folder;    ///< empty: a free one, named as the pipeline
  std::string repeated;  ///< frames.jsonl of the run that is repeated, or empty
  std::vector<std::string> settings, dumped;
  std::vector<Patch> patches{};
  std::vector<std::string> doubts{};  ///< further warnings of the run
  bool restarts = false;              ///< see RunOptions
  bool quiet = false;
  bool keeps_records = true;     ///< see RunOptions
  bool paranoid = false;         ///< inputs are protected, see RunOptions
  std::string isolate = "auto";  ///< see isolating_of()
  /// Called before the first frame, when all sinks are open.
  std::function<void(const PipelineConfig& config)> started{};
  /// Called after the errors of an invalid pipeline were printed.
  std::function<void(const ConfigReport& report)> refused{};
  /// Called after the error of a legal pipeline that could not run.
  std::function<void(const PipelineConfig& config, const Error& error)> failed{};
};

/// How many frames a run took, and in how many of them the shape has these states.
struct RunCounts {
  std::int64_t frames = 0, estimated = 0, weak = 0;
  std::optional<std::vector<std::string>> restart{};  ///< see RunSummary
};

/// Checks and runs a pipeline with progress on stderr; prints the results and errors. All counts
/// are 0 if it could not run.
RunCounts run(const RunArguments& arguments, Context& context);

}  // namespace weft::cli
