// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "host/records/record.hpp"
#include "host/workers/isolation.hpp"
#include "host/workers/message.hpp"
#include "host/workers/shared_inputs.hpp"

namespace weft::host {

/// What the workers of one lane share.
struct Workplace {
  std::uint64_t run_seed = 0;
  int threads = 1;  ///< that a call may use
  std::shared_ptr<SharedInputs> inputs;
  std::shared_ptr<std::atomic<bool>> cancel;  ///< in memory that workers read
  std::function<bool()> cancelled;
  std::function<void(const std::string& component, int level, const std::string& text,
                     std::uint64_t frame)>
      log;
};

class WorkerProcess;
class Loans;

/// A component, with those nested in it, in a process of its own. When that process dies or does
/// not answer, the call fails with the cause; before the next one it is started and prepared again.
/// One call at a time.
class Worker {
 public:
  struct Answer {
    std::int32_t status = WEFT_OK;
    Error error;  ///< for degenerate its message is the reason
    std::vector<std::pair<std::string, std::shared_ptr<Record>>> outputs;  ///< by slot, unchecked
    std::vector<PlacedTiming> timings;                                     ///< nested components
    std::uint64_t downloaded_bytes = 0;                                    ///< see host::Outcome
    double processor_ms = 0.0;                                             ///< [] ms spent there
  };

  Worker(Isolation isolation, Workplace workplace, CreateMessage component);
  ~Worker();

  /// Starts the process and creates the component there.
  Result<void> start();

  /// Remembers the records by slot, for itself and later starts, and prepares the component.
  Result<void> prepare(std::vector<std::pair<std::string, RecordPtr>> inputs);

  /// Creates and prepares another component in the same process, unless it is there: the producer
  /// of a warp that the component reads.
  Result<void> learn(const CreateMessage& component);

  /// Calls a method. Fails when the process did; what the component answers is an Answer.
  Result<Answer> process(int method, std::uint64_t frame, std::uint64_t draw,
                         std::span<const weft_record> inputs);

 private:
  Result<void> ready();
  Result<void> introduce(const CreateMessage& component);
  Result<void> prepare_there(std::uint64_t handle);
  Result<std::vector<PlacedRecord>> place(std::span<const weft_record> records,
                                          std::vector<std::shared_ptr<void>>& keep) const;
  Result<ReplyMessage> converse(MessageKind kind, const std::string& content,
                                std::chrono::milliseconds deadline = {});
  Result<ReplyMessage> fail(const std::string& cause, Errc code = Errc::plugin_failure);
  Result<ReplyMessage> died();
  Result<std::shared_ptr<Record>> adopt(const PlacedRecord& placed) const;

  Isolation isolation_;
  Workplace workplace_;
  CreateMessage component_;
  std::vector<std::pair<std::string, RecordPtr>> prepared_;
  std::unique_ptr<WorkerProcess> process_;  ///< null before the first start and after a death
  std::shared_ptr<Loans> loans_;
  std::set<std::uint64_t> known_;            ///< handles of the components in the process
  std::vector<std::shared_ptr<void>> kept_;  ///< inputs of prepare, while the process lives
};

}  // namespace weft::host
