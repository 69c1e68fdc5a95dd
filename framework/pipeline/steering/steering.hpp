// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "pipeline/execution/executor.hpp"
#include "pipeline/steering/change_maker.hpp"
#include "pipeline/steering/repeated_frames.hpp"

namespace weft {

/// Lets clients of the sinks change a run, save its settings, pause and end it. They can request
/// that it starts again with other settings. An earlier run can take their place: its changes are
/// repeated at their frames. Changes are made in a separate thread. All functions are for the
/// thread that begins frames.
class Steering {
 public:
  /// `sinks` are those at which users may steer, and `folder` is that of the run, for settings that
  /// they save. `restarts`: whether the caller starts a run again where they request it. The
  /// executor and its execution context outlive this object.
  Steering(ChangeMaker maker, Executor& executor, std::vector<const host::Instance*> sinks,
           ChangesByFrame repeated, std::string folder, bool restarts);

  /// Ends the thread. Changes that reached no frame are discarded.
  ~Steering();
  Steering(const Steering&) = delete;
  Steering& operator=(const Steering&) = delete;

  /// Before a frame is read: applies change requests, and waits while frames pause. Returns false
  /// if the run is to end or is `cancelled`, which is polled.
  bool wait_for_turn(const std::function<bool()>& cancelled);

  /// Between the reading of a frame and its begin: from this frame on, what is ready holds. Gives
  /// the settings then, or nothing where they are those of the frame before. Fails where a change
  /// cannot be repeated.
  Result<std::optional<std::string>> change(std::uint64_t frame);

  /// True if a client requested the end of the run.
  bool has_ended() const { return pace_ == Pace::ended; }

  /// If it is to start again: the settings of that run that differ from this one as it began.
  std::optional<std::vector<std::string>> restart();

  /// Records the changes that the current frame applied, and answers the clients that requested
  /// them.
  void note(FrameResult& frame);

 private:
  struct Asked {
    const host::Instance* sink = nullptr;  ///< null: an earlier run
    std::uint64_t number = 0;              ///< identifier that the sink assigned
    std::string setting;                   ///< "PATH=VALUE", or a JSON list of these to restart
    enum class Kind { change, save, restart } kind = Kind::change;
  };
  struct Made {
    Asked asked;
    PipelineChange change;
  };
  enum class Pace { going, stepping, pausing, ended };

  void take_change_requests();
  void hear(const host::Instance& sink, const ChangeRequest& request);
  void ask(Asked asked);
  Result<void> repeat(std::uint64_t frame);
  void make_all();
  void save(const Asked& asked) const;
  void prepare_restart(const Asked& asked);

  ChangeMaker maker_;  ///< for the thread
  Executor& executor_;
  std::vector<const host::Instance*> sinks_;
  ChangesByFrame repeated_;
  std::string folder_;
  bool restarts_;
  Pace pace_ = Pace::going;
  std::uint64_t next_frame_ = 0;  ///< the least number that it can have
  std::vector<Asked> applied_;    ///< changes that the current frame applies

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Asked> asked_;
  std::deque<Made> made_;
  std::optional<Error> failure_;  ///< to repeat a change
  std::optional<std::vector<std::string>> restart_;
  bool is_making_ = false, is_over_ = false;
  std::thread thread_;
};

}  // namespace weft
