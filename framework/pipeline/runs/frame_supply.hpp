// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "pipeline/execution/input.hpp"
#include "pipeline/runs/clock.hpp"
#include "pipeline/steering/repeated_frames.hpp"

namespace weft {

/// The frames of a run, in the order in which it takes them. Pipeline input, context and clock
/// outlive it.
class FrameSupply {
 public:
  virtual ~FrameSupply() = default;

  /// Starts to read ahead, where it does so.
  virtual void start() {}

  /// False where the run is known to have no frame at this place.
  virtual bool has(std::uint64_t place) const = 0;

  /// The frame at this place of the run, waited for. Nothing behind the last one, or when the run
  /// was cancelled meanwhile.
  virtual std::optional<PipelineInput::Frame> take(std::uint64_t place) = 0;

  /// Ends reading ahead; a source that waits for a frame is cancelled.
  virtual void stop() {}
};

/// Each frame of the source.
std::unique_ptr<FrameSupply> all_frames(PipelineInput& input);

/// The newest frame whenever the run takes one (`realtime: latest`), see LatestFrames. `dropped` is
/// called with the number of each frame that the run skips, from the reading thread.
std::unique_ptr<FrameSupply> newest_frames(PipelineInput& input, host::ExecutionContext& context,
                                           Clock& clock, std::function<bool()> is_cancelled,
                                           std::function<void(std::uint64_t)> dropped);

/// The frames that an earlier run took. Fails where the source has other ones.
Result<std::unique_ptr<FrameSupply>> repeated_frames(const RecordedRun& run, PipelineInput& input,
                                                     host::ExecutionContext& context);

}  // namespace weft
