// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <weft/core/result.hpp>

#include "host/workers/channel.hpp"
#include "process/child.hpp"

namespace weft::host {

/// A running worker program: a child of this process with its own process group, so that an
/// interrupt from the terminal does not reach it. It is supervised (process/supervisor.hpp): what
/// it starts ends with it. The end of what libraries print there is kept in memory.
class WorkerProcess {
 public:
  /// `program` is the path of weft-worker, empty for the one beside the running program. The files
  /// are those of the shared memories.
  static Result<std::unique_ptr<WorkerProcess>> start(const std::string& program, int inputs_file,
                                                      int outputs_file);

  /// Lets it end by itself, and ends it when it does not.
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  Channel& channel() { return *channel_; }

  /// True if it has died by itself.
  bool is_gone() { return child_->ending().has_value(); }

  /// Ends it and waits until it is gone.
  void kill() { child_->end(); }

  /// After its end of the channel was closed: how it ended, and its last printed line. "died of
  /// signal 11 (Segmentation fault)". The code is no_memory where SIGKILL ended it.
  Error cause_of_death();

  /// Bounds what is kept of its printing. Returns the size of what is dropped [bytes].
  std::uint64_t forget_old_output() { return child_->empty_memory(); }

 private:
  WorkerProcess(std::unique_ptr<Channel> channel, std::unique_ptr<process::Child> child)
      : channel_(std::move(channel)), child_(std::move(child)) {}

  std::unique_ptr<Channel> channel_;
  std::unique_ptr<process::Child> child_;
};

}  // namespace weft::host
