// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "pipeline/execution/executor.hpp"

namespace weft {

/// The source and the template of a pipeline, opened: what its stages are prepared with and what
/// enters them in every frame.
class PipelineInput {
 public:
  /// Opens the source and builds the template; both are checked. With a camera, which the execution
  /// context has admitted, no source is opened: frames are handed in.
  static Result<PipelineInput> open(const PipelineConfig& config, host::ExecutionContext& context,
                                    host::RecordPtr camera = nullptr);

  const host::RecordPtr& templ() const { return template_; }
  const host::RecordPtr& camera() const { return camera_; }
  /// [frames] -1 when unknown.
  std::int64_t frames() const { return frames_; }
  /// Frames come by themselves: one that is not read in time is lost.
  bool is_live() const { return is_live_; }

  struct Frame {
    FrameInput input;
    StageReport report;  ///< report of the source
  };

  /// One frame, or nothing where a source of unknown length has come to its end. The records of the
  /// source must fit the template and the camera; its matches are completed, see Correspondences.
  std::optional<Frame> read(std::uint64_t index);

  /// A frame of records that the execution context has admitted, held to the same rules. The Error
  /// names the slot of the one that does not fit.
  Result<Frame> take(std::uint64_t index, host::NamedRecords records);

 private:
  PipelineInput(const PipelineConfig& config, host::ExecutionContext& context)
      : config_(&config),
        context_(&context),
        source_name_(config.source ? config.source->name : "sources") {}
  Result<void> open_source();
  Result<void> use_camera(host::RecordPtr camera);
  Result<void> build_template();
  host::Outcome read_checked(std::uint64_t index);
  Frame frame_of(std::uint64_t index, host::Outcome read, host::Spent took) const;
  Result<host::RecordPtr> completed(const host::RecordPtr& record);

  const PipelineConfig* config_;
  host::ExecutionContext* context_;
  host::SharedText source_name_;
  host::Instance* source_ = nullptr;
  host::RecordPtr camera_;
  host::RecordPtr template_;
  std::optional<MatchPlacer> placer_;
  std::int64_t frames_ = -1;
  bool is_live_ = false;
};

}  // namespace weft
