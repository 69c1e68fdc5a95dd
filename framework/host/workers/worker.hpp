// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/workers/worker_session.hpp"

namespace weft::host {

/// A component, with those nested in it, in a separate process. If that process dies or does not
/// answer, the call fails with the cause. Meanwhile another process is started and prepared, for
/// which the next call waits. One call at a time.
class Worker {
 public:
  struct Answer {
    std::int32_t status = WEFT_OK;  ///< weft_status
    Error error;                    ///< for degenerate its message is the reason
    std::vector<std::pair<std::string, std::shared_ptr<Record>>> outputs;  ///< by slot, unchecked
    std::vector<PlacedTiming> timings;                                     ///< nested components
    std::uint64_t downloaded_bytes = 0;                                    ///< see host::Outcome
    double processor_ms = 0.0;                                             ///< [] ms spent there
  };

  Worker(Isolation isolation, WorkerContext context, CreateMessage component);
  ~Worker();

  /// Starts the process and creates the component there.
  Result<void> start();

  /// Remembers the records by slot, for itself and later starts, and prepares the component.
  Result<void> prepare(InputsBySlot inputs);

  /// Creates and prepares another component in the same process, unless it is there: the producer
  /// of a warp that the component reads.
  Result<void> learn(const CreateMessage& component);

  /// From now on a process that is started again is given this call, which has no inputs, before
  /// others: a source is opened.
  void begin_with(int method, std::uint64_t frame);

  /// Calls a method. Fails when the process did; what the component answers is an Answer.
  /// `deadline` as in ExecutionContext::call.
  Result<Answer> process(int method, std::uint64_t frame, std::uint64_t draw,
                         std::span<const weft_record> inputs,
                         std::chrono::steady_clock::time_point deadline);

 private:
  using Made = Result<std::unique_ptr<WorkerSession>>;

  Made make_session(const std::vector<CreateMessage>& learned, const std::atomic<bool>* unwanted);
  Result<void> begin(WorkerSession& session) const;
  Result<void> ready();
  void note_death(const Error& death);
  void bound_output(std::uint64_t frame);
  void make_spare();
  void end_spare();

  Isolation isolation_;
  WorkerContext context_;
  CreateMessage component_;
  InputsBySlot prepared_;
  std::vector<CreateMessage> learned_;
  std::optional<CallMessage> beginning_;
  std::unique_ptr<WorkerSession> session_;        ///< null before the first start and after a death
  std::chrono::steady_clock::duration making_{};  ///< time to start and prepare it
  std::atomic<bool> ending_{false};               ///< no spare is wanted any more
  std::future<Made> spare_;                       ///< being made, or ready
};

}  // namespace weft::host
