// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pipeline/dumps/dump.hpp"
#include "pipeline/runs/frame_loop.hpp"
#include "pipeline/runs/run_folder.hpp"
#include "pipeline/runs/trace.hpp"

namespace weft {

/// Writes the files of a run while it runs: the lines and records of its frames, the trace of its
/// calls, and the calls of dumped stages.
class RunRecorder {
 public:
  /// Creates the folder and writes what is known before the first frame. A failure leaves no folder
  /// behind. `keeps_records`: whether the records of each frame are kept beside its line.
  static Result<RunRecorder> create(const std::string& folder, const CheckedPipeline& pipeline,
                                    const PipelineInput& input,
                                    const std::vector<std::string>& dumped_stages,
                                    bool keeps_records);

  const std::string& folder() const { return folder_.path(); }

  /// Writes a frame; the frames come in their order.
  Result<void> add(const FrameOnItsWay& frame);

  /// Writes calls outside of frames.
  Result<void> add(host::Timings calls);

  /// Completes the trace; no call is added after it.
  Result<void> close_trace() { return trace_.close(); }

  /// Writes all to the disk and marks the run as complete.
  Result<void> end(const RunSummary& summary) const;

  /// Removes all that the run wrote.
  void withdraw() { folder_.withdraw(); }

 private:
  RunRecorder(const CheckedPipeline& pipeline, RunFolder folder, Trace trace, Dump dump,
              bool keeps_records)
      : pipeline_(&pipeline),
        folder_(std::move(folder)),
        trace_(std::move(trace)),
        dump_(std::move(dump)),
        keeps_records_(keeps_records) {}

  const CheckedPipeline* pipeline_;
  RunFolder folder_;
  Trace trace_;
  Dump dump_;
  bool keeps_records_;
};

}  // namespace weft
