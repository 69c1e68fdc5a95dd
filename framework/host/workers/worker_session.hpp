// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/records/record.hpp"
#include "host/workers/isolation.hpp"
#include "host/workers/message.hpp"
#include "host/workers/shared_inputs.hpp"
#include "host/workers/worker_process.hpp"

namespace weft::host {

constexpr int kWarning = 2;  ///< level of a log, as of weft_host.log

/// Settings and memory of a worker. Workers of one execution context share most of it.
struct WorkerContext {
  std::uint64_t run_seed = 0;  ///< [] seed of the run
  int threads = 1;             ///< that a call may use
  std::shared_ptr<SharedInputs> inputs;
  std::shared_ptr<std::atomic<bool>> cancel;  ///< in memory that workers read
  std::function<bool()> cancelled;
  std::function<void(const std::string& component, int level, const std::string& text,
                     std::uint64_t frame)>
      log;
};

class Loans;
using InputsBySlot = std::vector<std::pair<std::string, RecordPtr>>;

/// The error of a reply, whose texts and code are those of another process.
Error error_in(const ReplyMessage& reply);

/// One process in which a component lives, and the messages that it got.
class WorkerSession {
 public:
  /// While `unwanted` is given, no call waits for the session. A background thread may make it,
  /// which gives up once the flag is set. The output of the component is then discarded.
  WorkerSession(const WorkerContext& context, std::string id, const std::atomic<bool>* unwanted);
  ~WorkerSession();
  WorkerSession(const WorkerSession&) = delete;
  WorkerSession& operator=(const WorkerSession&) = delete;

  /// From now on, a call uses it.
  void take() { unwanted_ = nullptr; }

  /// Starts the process.
  Result<void> start(const std::string& program);

  /// Creates and prepares components there. A library is given at least ten seconds to load, and
  /// all that it wants when there is no deadline (0).
  Result<void> create(const CreateMessage& component, std::chrono::milliseconds deadline);
  Result<void> prepare(std::uint64_t handle, const InputsBySlot& inputs);
  Result<void> learn(const CreateMessage& component, const InputsBySlot& inputs,
                     std::chrono::milliseconds deadline);
  bool knows(std::uint64_t handle) const { return known_.count(handle) != 0; }

  /// The inputs of a call, with those copies in `keep` that are made for it alone.
  Result<std::vector<PlacedRecord>> place(std::span<const weft_record> records,
                                          std::vector<std::shared_ptr<void>>& keep) const;

  /// Sends a message and waits for the answer. If the process does not answer, it is ended. Its own
  /// death ends the wait, even if another process has its end of the channel open.
  Result<ReplyMessage> converse(MessageKind kind, const std::string& content,
                                std::chrono::milliseconds deadline = {});

  /// A record that an answer names; the memory is given back with its last reference. Where there
  /// is no such memory, the process is ended.
  Result<std::shared_ptr<Record>> adopt(const PlacedRecord& placed);

  /// Offsets of arrays that this process has done with, once each.
  std::vector<std::uint64_t> returned();

  bool is_lost() const { return process_ == nullptr; }  ///< it was ended
  bool is_gone() { return process_ == nullptr || process_->is_gone(); }
  std::uint64_t forget_old_output() { return process_->forget_old_output(); }

 private:
  bool is_taken() const { return unwanted_ == nullptr; }
  Error fail(const std::string& cause, Errc code = Errc::plugin_failure);
  Error died();

  const WorkerContext& context_;
  std::string id_;
  const std::atomic<bool>* unwanted_;
  std::unique_ptr<WorkerProcess> process_;
  std::uint64_t calls_ = 0;  ///< made of this process, which number its answers
  std::shared_ptr<Loans> loans_;
  std::set<std::uint64_t> known_;            ///< handles of the components there
  std::vector<std::shared_ptr<void>> kept_;  ///< inputs of prepare
};

}  // namespace weft::host
