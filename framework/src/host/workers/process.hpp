// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>
#include <weft/core/result.hpp>

#include "host/workers/channel.hpp"

namespace weft::host {

/// A running worker program: a child of this process with its own process group, so that an
/// interrupt from the terminal does not reach it. It is supervised (host/supervising): what it
/// starts ends with it. The end of what libraries print there is kept in memory.
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

  /// Whether it has died by itself.
  bool is_gone() { return reap(0); }

  /// Ends it and waits until it is gone.
  void kill();

  /// After its end of the channel was closed: how it ended, and its last printed line. "died of
  /// signal 11 (Segmentation fault)". The code is no_memory where somebody else killed it.
  Error cause_of_death();

  /// Bounds what is kept of its printing. [bytes] that it had printed, where they were too many.
  std::uint64_t forget_old_output();

 private:
  WorkerProcess(pid_t id, std::unique_ptr<Channel> channel, int output)
      : id_(id), channel_(std::move(channel)), output_(output) {}
  bool reap(int patience_ms);
  std::string last_line() const;

  pid_t id_;  ///< 0 once it is gone and waited for
  std::unique_ptr<Channel> channel_;
  int output_;      ///< the memory file that it prints to
  int status_ = 0;  ///< as waitpid() gave it; -1 when another part of this program took it
};

}  // namespace weft::host
