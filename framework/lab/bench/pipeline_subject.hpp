// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <map>
#include <memory>

#include "lab/bench/measure.hpp"
#include "pipeline/runs/frame_loop.hpp"

namespace weft::bench {

/// [bytes] of the records that a stage reads and makes in a frame. Template and camera, which it
/// has from its set-up, do not count as read. Records that it passes on unchanged do not count as
/// made.
struct Moved {
  std::uint64_t in = 0, out = 0;  ///< [bytes] read; made
};
Moved moved_by(const Node& node, const Graph& graph, const FrameResult& frame);

/// A pipeline without its sinks.
CheckedPipeline without_sinks(CheckedPipeline pipeline);

/// A pipeline with its first frames in memory.
class PipelineSubject final : public Subject {
 public:
  /// Opens the pipeline and reads at most `frames` frames, fewer if its source has fewer. `cancel`
  /// outlives the subject. Only the pipeline's sinks write files.
  static Result<std::unique_ptr<PipelineSubject>> open(CheckedPipeline pipeline,
                                                       std::int64_t frames,
                                                       const std::atomic<bool>& cancel);
  ~PipelineSubject() override;

  const std::vector<std::string>& parts() const override { return parts_; }
  void restart() override { loop_->restart(); }
  Result<FrameSpent> run(std::int64_t frame) override;
  Result<Overlapped> run_overlapping(std::int64_t frames) override;

  /// Ids of the components of the parts; a part with a separate component for the template has that
  /// too.
  std::vector<std::string> components() const;
  /// Cost of the source for each frame.
  const std::vector<StageReport>& reading() const { return reading_; }
  const PipelineConfig& config() const { return pipeline_.config; }
  /// [bytes] of all runs of each part, and the runs in which it was not skipped.
  struct MovedInAll {
    Moved bytes;
    std::int64_t runs = 0;  ///< [] number of runs
  };
  const std::vector<MovedInAll>& moved() const { return moved_; }
  /// Frames by the state of their shape: "estimated", warm-up included.
  const std::map<std::string, std::int64_t>& states() const { return states_; }

 private:
  PipelineSubject(CheckedPipeline pipeline, const std::atomic<bool>& cancel)
      : pipeline_(std::move(pipeline)), cancel_(cancel) {}
  Result<void> open_all(std::int64_t frames);
  void note(const FrameResult& result);
  Error blamed(const FrameResult& result) const;

  CheckedPipeline pipeline_;
  const std::atomic<bool>& cancel_;
  std::unique_ptr<host::ExecutionContext> context_;
  std::unique_ptr<FrameLoop> loop_;
  std::vector<PipelineInput::Frame> frames_;
  std::vector<StageReport> reading_;
  std::vector<std::string> parts_;
  std::vector<MovedInAll> moved_;
  std::map<std::string, std::int64_t> states_;
};

/// Reduces the number of frames to what all subjects have. Fails if that is below 2, and with
/// `exact` if it is below the number in the settings.
Result<Settings> settled(const Settings& settings,
                         const std::vector<std::unique_ptr<PipelineSubject>>& subjects, bool exact);

/// The first error of a frame: "frame 3: filters: ...", or that it was cancelled.
Error error_of(const FrameResult& result, bool cancelled);

}  // namespace weft::bench
