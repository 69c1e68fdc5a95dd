// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "pipeline/execution/executor.hpp"

namespace weft {

/// The calls of a run on a time line for Perfetto and chrome://tracing. The file has the Trace
/// Event Format, as an array of complete events:
/// https://perfetto.dev/docs/getting-started/other-formats
///
/// A call is nested in the call that made it, and all calls of a frame in a slice called "frame".
/// Each process has its own track. Times are those of the host's steady clock, from the first call
/// on. Events are flushed after each frame; readers accept the array of a killed run, which lacks
/// its end.
class Trace {
 public:
  /// Fails with io when the file cannot be created.
  static Result<Trace> create(const std::string& file);

  /// Calls outside of frames.
  Result<void> add(host::Timings calls);

  /// A frame with its calls.
  Result<void> add(const FrameResult& frame);

  /// Ends the array; nothing is to be added after it.
  Result<void> close();

 private:
  using Time = std::chrono::steady_clock::time_point;

  explicit Trace(std::string file) : file_(std::move(file)) {}
  double since_origin_us(Time time) const;
  int track_of(const std::string& worker);
  void add_calls(host::Timings calls);
  void put(const std::string& event);
  Result<void> flush();

  std::string file_;
  std::ofstream stream_;
  bool is_empty_ = true;
  Time origin_{};                      ///< the start of the first call
  std::map<std::string, int> tracks_;  ///< by the stage of a worker, "" for this process
};

}  // namespace weft
