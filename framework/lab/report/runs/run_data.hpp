// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/result.hpp>

#include "lab/metrics/run_metrics.hpp"
#include "lab/report/runs/flat_print.hpp"
#include "lab/results/cell_folder.hpp"

namespace weft::lab {

/// Outcome of a stage in a frame.
struct StageOutcome {
  std::string stage;
  std::string status;    ///< ok, degenerate, no_result, error or skipped
  std::string reason;    ///< empty for ok
  double ms = kUnknown;  ///< [] ms, wall-clock time

  /// A skipped stage takes no time.
  bool has_run() const { return status != "skipped" && std::isfinite(ms); }
};

/// A line of frames.jsonl, as far as the page shows it.
struct RunFrame {
  std::uint64_t frame = 0;                                        ///< [] index from 0
  std::string state;                                              ///< state of the shape
  std::string reason;                                             ///< why it is weak, if it is
  double mean_mm = kUnknown, worst_mm = kUnknown;                 ///< [] mm, where there is truth
  double confidence = kUnknown;                                   ///< [] 0 to 1
  double within_1mm_percent = kUnknown, displaced_mm = kUnknown;  ///< against a flat reference
  std::vector<StageOutcome> stages;                               ///< in their order, sinks last
  std::vector<std::string> warnings;                              ///< [.] texts

  /// False where the shape is predicted, an old one, or none.
  bool is_measured() const { return state == "estimated" || state == "weak"; }
};

/// A worst frame with its image, if the run has a video of all its frames.
struct WorstFrame {
  std::uint64_t frame = 0;  ///< [] index of the frame
  std::string jpeg;
};

struct RunData {
  std::string folder;
  std::string version, git, processor;
  std::string pipeline;  ///< the file that was run
  std::string settings;  ///< the effective configuration, as YAML
  RunMetrics metrics;
  std::vector<RunFrame> frames;   ///< ascending
  CellView view;                  ///< some frames, the worst among them
  std::vector<WorstFrame> worst;  ///< the worst first; without truth the least sure ones
  FlatPrint print;                ///< comparison with the flat texture; for some runs
};

/// The first of these frames: "22, 23, 31, ...".
std::string first_frames(const std::vector<std::uint64_t>& frames);

/// Reads and evaluates a run folder; fails as evaluate_run does. `unwarping_sink` as in
/// ReportOptions.
Result<RunData> read_run_data(const std::string& folder, const std::string& unwarping_sink = {});

}  // namespace weft::lab
