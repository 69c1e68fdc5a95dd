// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "lab/bench/schedule.hpp"
#include "pipeline/execution/frame_result.hpp"

namespace weft::bench {

/// Cost of a part of a pipeline in a frame.
struct PartSpent {
  StageStatus status = StageStatus::ok;
  host::Spent took;
};

/// Cost of a frame, without that of the source, which had read it before.
struct FrameSpent {
  host::Spent whole;
  std::vector<PartSpent> parts;  ///< one for each of Subject::parts()
};

/// The frames of a sequence on their way through a pipeline, several at once. The next frame enters
/// as soon as it may: none waits for a source.
struct Overlapped {
  struct Passage {
    double entered_ms = 0.0, left_ms = 0.0;  ///< [] ms since the sequence began
  };
  std::vector<Passage> frames;  ///< [.] one per frame
  host::Spent whole;            ///< by all frames together
};

/// The subject of a measurement: something that runs frames it has at hand.
class Subject {
 public:
  virtual ~Subject() = default;

  /// Names of the stages, and of the sinks where they take part.
  virtual const std::vector<std::string>& parts() const = 0;

  /// The next frame is the first of a sequence.
  virtual void restart() = 0;

  /// Fails with the error that a stage had, or with cancelled.
  virtual Result<FrameSpent> run(std::int64_t frame) = 0;

  /// Runs the first frames as a sequence, as many at once as a run would. Fails as run().
  virtual Result<Overlapped> run_overlapping(std::int64_t frames) = 0;
};

/// Cost of a frame that took `here` of this process; the work of workers for it is added.
FrameSpent spent_in(const FrameResult& result, host::Spent here);

/// A frame that counts.
struct Sample {
  std::int64_t turn = 0;   ///< see Turn::number
  int repetition = 0;      ///< [] index from 0
  std::int64_t frame = 0;  ///< [] index from 0 of the source
  FrameSpent spent;
};

/// Receives after each turn how many of all are done.
using Progress = std::function<void(std::size_t done, std::size_t turns)>;

/// Runs the turns; the samples of each subject in the order of its frames. Ends with the first
/// error.
Result<std::vector<std::vector<Sample>>> measure(const Settings& settings,
                                                 std::span<Subject* const> subjects,
                                                 const Progress& progress);

}  // namespace weft::bench
