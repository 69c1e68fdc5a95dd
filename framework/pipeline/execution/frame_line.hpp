// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

namespace weft {

/// Steps that must be over before a frame may take a step, beside the steps before it and the same
/// step of the frame before.
struct StepRule {
  /// [frames] That far back, a frame must be settled; 0: none. Steps that read `previous.T@lag`.
  int frames_back = 0;
  /// [steps] number of further steps that the previous frame must have completed too. Later steps
  /// of a frame call this step's component again, as those of a warp do.
  std::size_t busy_for = 0;
};

/// Frames on their way through the same steps, several at a time. Each frame takes the steps one
/// after another, and each step takes the frames in their order and one at a time. The result of a
/// step can thus depend only on the frames before, not on the number of threads.
class FrameLine {
 public:
  /// Outcome of a step for its frame.
  enum class Answer {
    passed,     ///< it goes on to the next step
    not_there,  ///< the sequence ended before it; the frames before it go on
    last,       ///< this frame is the last one: those behind it are dropped
  };
  /// Called from any of the threads; `frame` counts from 0.
  using Work = std::function<Answer(std::size_t step, std::uint64_t frame)>;

  /// One rule a step. A frame is settled when it has taken the step `settled`.
  /// At most `frames_at_once` frames are on their way, at least 1.
  FrameLine(std::vector<StepRule> rules, std::size_t settled, std::size_t frames_at_once);

  /// Takes frames through all steps, on this thread and `threads` - 1 more, until a step reports
  /// that there are no more. An exception of a step ends it as `last` does, and is thrown again at
  /// the end; of several, that of the first frame.
  void run(int threads, const Work& work);

 private:
  struct Traveller {
    std::size_t passed = 0;  ///< steps
    bool is_busy = false;
  };
  struct Turn {
    std::size_t step;     ///< [] index of the step
    std::uint64_t frame;  ///< [] index of the frame
  };

  void travel(const Work& work);
  std::optional<Turn> next_turn();
  bool may_go(std::uint64_t frame, std::size_t step) const;
  bool has_passed(std::uint64_t frame, std::size_t step) const;
  void note(const Turn& turn, Answer answer);
  void drop_from(std::uint64_t frame);
  void retire();

  std::vector<StepRule> rules_;
  std::size_t settled_;
  std::size_t frames_at_once_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Traveller> travellers_;  ///< frames from first_ on
  std::uint64_t first_ = 0;
  std::uint64_t end_ = ~std::uint64_t{0};  ///< no frame from here on is wanted
  std::exception_ptr failure_;
  std::uint64_t failed_frame_ = ~std::uint64_t{0};
};

}  // namespace weft
