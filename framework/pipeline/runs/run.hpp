// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/loading/component_checks.hpp"
#include "pipeline/execution/executor.hpp"
#include "pipeline/execution/run_warning.hpp"
#include "pipeline/runs/clock.hpp"
#include "pipeline/steering/repeated_frames.hpp"
#include "pipeline/steering/steering.hpp"

namespace weft {

/// Receives the progress of a run, from the threads that run it.
class RunObserver {
 public:
  virtual ~RunObserver() = default;
  /// `frames` is -1 when unknown.
  virtual void started(std::int64_t frames) = 0;
  /// Called in the order of the frames, one at a time, when the frame's part of the run folder is
  /// written; later frames may already be on their way.
  virtual void frame_done(const FrameResult& frame) = 0;
  /// The component that runs from now on in this thread: that of a stage. `frame` is
  /// host::kOfflineFrame before and after the frames.
  virtual void calling(const std::string& /*stage*/, const std::string& /*component*/,
                       const std::string& /*action*/, std::uint64_t /*frame*/) {}
  /// It has ended.
  virtual void called() {}
};

struct RunSummary {
  std::string folder;
  std::int64_t frames = 0;   ///< [] number of frames
  std::int64_t failed = 0;   ///< frames with an error in a stage, the source or a sink
  std::int64_t dropped = 0;  ///< frames of the source between those, with `realtime: latest`
  /// If a client requested that it starts again: with these settings merged into the pipeline.
  std::optional<std::vector<std::string>> restart;
  bool stopped = false;    ///< by on_error: stop, or cancelled
  bool cancelled = false;  ///< without a frame, also when it was not yet open: no folder is left
  std::map<std::string, std::int64_t> late_in;  ///< frames over budget_ms by the stage in which
                                                ///< that time passed
  std::vector<RunWarning> warnings;             ///< the first 100 of each text, and how many more
  /// Evidence of all frames together about the camera, see SetupMonitor::camera().
  std::vector<std::pair<std::string, double>> camera;
};

/// Loads and wires a pipeline. Refuses outputs that would overwrite existing files or inputs. Runs
/// the components' checks of their files and parameters. Use the pipeline only if the report is ok.
/// `output_folder` is the run folder, new or empty; without a name, no component may write.
/// `settings` and `patches` as in load_pipeline. `checks` skips the checks that it already ran for
/// earlier pipelines.
std::pair<CheckedPipeline, ConfigReport> check_pipeline(
    const std::string& file, const host::Registry& registry, const std::string& output_folder,
    const std::vector<std::string>& settings = {}, const std::vector<Patch>& patches = {},
    host::ComponentChecks* checks = nullptr);

/// The same of a document that has been read from `file`.
std::pair<CheckedPipeline, ConfigReport> check_pipeline(const std::string& file,
                                                        PipelineDocument document,
                                                        const host::Registry& registry,
                                                        const std::string& output_folder,
                                                        host::ComponentChecks* checks = nullptr);

/// The same for a run that continues in its folder, with `settings` that override those of the run.
/// The Error is the first one found. Outputs are not checked: they are those of the run.
Result<CheckedPipeline> check_change(const PipelineConfig& running, const std::string& folder,
                                     const host::Registry& registry,
                                     const std::vector<std::string>& settings);

struct RunOptions {
  /// Stages whose calls are written too, see Dump.
  std::vector<std::string> dumped{};
  /// With `realtime: latest` it determines when the frames of a source that is not live are there;
  /// null: the clock of the machine.
  Clock* clock = nullptr;
  /// With it a run that has a folder can be changed while it runs, by those at its sinks.
  const host::Registry* registry = nullptr;
  /// To be done again, which needs `registry` and a folder, and a pipeline that takes all frames.
  std::optional<RecordedRun> repeated{};
  /// True if the folder has the records of each frame; else only its lines are left.
  bool keeps_records = true;
  /// True if the caller starts the run again where RunSummary::restart demands it.
  bool restarts = false;
  bool protects_inputs = false;  ///< see host::ExecutionContext::protect_inputs()
};

/// Runs all frames of the source into `output_folder`, which must be new or empty; an empty name
/// leaves no run folder, only what the sinks write. Fails with the
/// first error before the first frame, or when the run folder cannot be written; errors of single
/// frames are recorded and counted. `cancel` may be set from another thread or a signal handler.
Result<RunSummary> run_pipeline(const CheckedPipeline& pipeline, const std::string& output_folder,
                                RunObserver& observer, const std::atomic<bool>& cancel,
                                RunOptions options = {});

}  // namespace weft
