// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "pipeline/execution/input.hpp"
#include "pipeline/runs/clock.hpp"

namespace weft {

/// Reads a source in its own thread, at the pace at which frames come, and keeps the newest one
/// alone. Frames that were not taken before the next one came are dropped, unless they could not be
/// read. The frames of a source that is not live come at their times, counted from the first one,
/// and those without a time as fast as they can be read.
class LatestFrames {
 public:
  /// From the reading thread.
  struct Source {
    std::function<std::optional<PipelineInput::Frame>(std::uint64_t index)> read;
    /// A frame that will not be processed.
    std::function<void(std::uint64_t index)> dropped;
    std::int64_t frames = -1;  ///< -1 when unknown: until `read` gives none
    bool is_live = false;      ///< `read` waits for the frame itself
  };

  /// Begins to read.
  LatestFrames(Source source, Clock& clock);

  /// Waits for `read` to return. The clock outlives this.
  ~LatestFrames();
  LatestFrames(const LatestFrames&) = delete;
  LatestFrames& operator=(const LatestFrames&) = delete;

  /// The newest frame; waits if it was taken already. It has the number of frames dropped before
  /// it. None behind the last frame, or when `cancelled`, which is polled. Throws the exceptions of
  /// `read`.
  std::optional<PipelineInput::Frame> take(const std::function<bool()>& cancelled);

  /// Nothing is read from now on.
  void stop();

 private:
  void read_all();
  bool read_next(std::uint64_t index);
  bool wait_for(const PipelineInput::Frame& frame);
  void offer(PipelineInput::Frame frame);

  Source source_;
  Clock& clock_;
  std::optional<Clock::Time> origin_;  ///< when a frame of time 0 is there

  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<PipelineInput::Frame> newest_;  ///< not taken
  bool is_stopped_ = false, has_ended_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace weft
