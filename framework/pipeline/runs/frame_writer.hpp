// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pthread.h>

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "pipeline/runs/frame_loop.hpp"

namespace weft {

/// Does slow work on frames for which no frame waits, such as writing them. It has its own thread,
/// and works in the order in which frames are put.
class FrameWriter {
 public:
  /// Called in that thread. An exception ends it: frames behind that one are dropped.
  using Write = std::function<void(FrameOnItsWay& frame)>;

  /// At most `bound` frames, at least 1, are with it, the one that is being written among them.
  FrameWriter(std::size_t bound, Write write);

  /// Drops what is not written; close() before that keeps it.
  ~FrameWriter();
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  /// Waits until there is room. False when writing has failed: the frame is dropped then, and no
  /// other one is wanted. From any thread, one at a time.
  bool put(FrameOnItsWay frame);

  /// Waits until all is written and ends the thread; throws what ended it before. Again: does
  /// nothing.
  void close();

  /// The clock of the CPU time that its thread has spent.
  clockid_t processor_clock() const { return processor_clock_; }

 private:
  void write_all();
  std::optional<FrameOnItsWay>& slot(std::size_t frame) { return frames_[frame % frames_.size()]; }

  Write write_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::optional<FrameOnItsWay>> frames_;  ///< by their number, modulo their bound
  std::size_t put_ = 0, written_ = 0;                 ///< [frames]
  bool is_closed_ = false, is_dropped_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
  clockid_t processor_clock_{};
};

}  // namespace weft
