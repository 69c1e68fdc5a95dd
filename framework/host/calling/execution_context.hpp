// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>
#include <weft/core/change_request.hpp>

#include "host/calling/call_times.hpp"
#include "host/calling/cancellation.hpp"
#include "host/calling/thread_shares.hpp"
#include "host/loading/component_spec.hpp"
#include "host/workers/isolation.hpp"

namespace weft::host {

inline constexpr SteadyTime kNoDeadline = SteadyTime::max();

class Instance;
class ProcessState;
class SharedInputs;
struct WorkerContext;

/// One set of component instances. Several threads may call instances of an execution context, each
/// instance and those nested in it one at a time; one more thread may make and prepare others
/// meanwhile. Everything else is for one thread.
class ExecutionContext {
 public:
  using Log = std::function<void(const std::string& component, int level, const std::string& text,
                                 std::uint64_t frame)>;
  /// Announces the next call: the stage, the id of its component, the action ("load", "prepare", a
  /// method) and the frame. The thread that runs the call also calls this function.
  using Announce = std::function<void(const std::string& stage, const std::string& component,
                                      const std::string& what, std::uint64_t frame)>;
  /// The call that this thread announced has ended.
  using AnnounceEnd = std::function<void()>;

  /// Outputs are stored in `arena` if it is given, which isolated instances need. Revisions have
  /// the bits of `revision_mark`.
  ExecutionContext(std::uint64_t run_seed, Log log, std::shared_ptr<SharedArena> arena = nullptr,
                   std::uint64_t revision_mark = 0);
  ~ExecutionContext();
  ExecutionContext(const ExecutionContext&) = delete;
  ExecutionContext& operator=(const ExecutionContext&) = delete;

  /// Instances made from now on draw from this run seed.
  void use_seed(std::uint64_t run_seed) { run_seed_ = run_seed; }

  /// Loads the library and creates the component and those nested in it; `path` is that of a nested
  /// component that stands alone here.
  Result<Instance*> instantiate(const ComponentSpec& spec, const std::string& stage,
                                const std::string& path = {});

  /// Creates the component and those nested in it in a worker: no library is loaded here.
  Result<Instance*> instantiate_isolated(const ComponentSpec& spec, const std::string& stage,
                                         const Isolation& isolation);

  /// Replaces an instance by another one, and destroys the old one with those nested in it. The new
  /// instance evaluates the results of the old one. Neither may be called meanwhile.
  void replace(Instance& old, Instance& made);

  /// Destroys an instance that is no longer called, with those nested in it.
  void discard(Instance& instance);

  /// Sets the number of threads that may work at a time, shared by the callers of this execution
  /// context. A call gets all that no other call has when it begins; in a worker it gets an equal
  /// share. Must precede the creation of instances. With more than one caller, CPU time is that of
  /// the calling thread alone.
  void divide_threads(int threads, int callers);

  /// Where the records of this execution context stand, and what else lives as long as a frame.
  const std::shared_ptr<MemoryPool>& memory() const { return memory_; }

  CallTimes& times() { return times_; }

  /// Nothing is created or prepared while cancellation is requested.
  Cancellation& cancellation() { return cancellation_; }

  /// From now on, components of this process get inputs that are read-only and unmapped after their
  /// call, so that an illegal access faults. Costs a copy of the inputs of each call.
  void protect_inputs() { protects_inputs_ = true; }

  /// Gives template and camera to an instance and to those nested in it.
  Result<void> prepare(Instance& instance, const Record& templ, const Record& camera);

  /// As above, for an instance of this process; the two are records as a call has them.
  Result<void> prepare_here(Instance& instance, std::span<const weft_record> inputs);

  /// Logs what is doubtful about a stage before the first frame, as a component warns.
  void warn(const std::string& stage, const std::string& text) const;

  /// Calls a method of a component; outputs are validated. Never throws.
  /// Components can query the time until `deadline`, see weft/budget.h.
  Outcome call(Instance& instance, int method, std::span<const weft_record> inputs,
               std::uint64_t frame, std::uint64_t draw = 0, SteadyTime deadline = kNoDeadline);

  /// Validates and numbers a record that is new in this execution context, because components
  /// identify records by their revisions. Templates and cameras are numbered by their content,
  /// other records by a number that is new in this process. `types` are the types that the
  /// component declares beside the catalogue's.
  Result<void> admit(Record& record, const char* slot, std::span<const RecordSchema> types = {});

  /// Evaluates a warp record at points, by its producer.
  Outcome evaluate(const Record& warp, const Points& points, std::uint64_t frame);

  /// From now on, the host does not cancel calls of this instance.
  static void let_finish(Instance& instance);

  /// True if a user may steer the run at this sink.
  static bool steers(const Instance& sink);
  /// The sink's change requests since the last call. Safe from any thread, as is `answer`.
  static Result<std::vector<ChangeRequest>> take_change_requests(const Instance& sink);
  static Result<void> answer(const Instance& sink, const ChangeAnswer& answer);

  /// Sets the functions that are called before and after components are created, prepared, called
  /// and destroyed, by the thread that does so. Nested components are not announced.
  void announce_to(Announce announce, AnnounceEnd announce_end) {
    announce_ = std::move(announce);
    announce_end_ = std::move(announce_end);
  }

 private:
  friend struct Callbacks;

  struct Announced;
  struct Scope;
  struct Turn;
  Instance& add(std::unique_ptr<Instance> instance);
  std::unique_ptr<Instance> take_out(Instance& instance);
  void destroy(std::unique_ptr<Instance> instance);
  void end(Instance& instance) const;
  /// Restores the state of the process and warns of what a stage changed.
  void warn_of_changes(const ProcessState& before, const std::string& stage,
                       const char* when) const;
  void tell_of_ended_copy(std::uint64_t run_frame) const;
  Result<WorkerContext> worker_context_of(const Instance& instance);
  Outcome enter(Instance& instance, int method, std::span<const weft_record> inputs,
                const Turn& turn);
  Outcome finish(Instance& instance, Scope& scope, std::span<const weft_record> inputs,
                 std::int32_t status, const weft_error& error);
  weft_call make_call(const Instance& instance, Scope& scope, int method) const;
  std::int32_t call_here(Instance& instance, const weft_call& call,
                         std::span<const weft_record> inputs, std::uint64_t run_frame,
                         weft_error& error) const;
  std::int32_t call_worker(Instance& instance, Scope& scope, int method,
                           std::span<const weft_record> inputs, weft_error* error);
  Instance* find(std::uint64_t handle) const;
  std::uint64_t run_seed_;
  Log log_;
  Announce announce_;
  AnnounceEnd announce_end_;
  mutable std::mutex instances_mutex_;
  std::vector<std::unique_ptr<Instance>> instances_;  ///< handle - 1 is the index; null: destroyed
  ThreadShares threads_;
  bool protects_inputs_ = false;
  std::shared_ptr<MemoryPool> memory_ = std::make_shared<MemoryPool>();
  CallTimes times_{memory_};
  std::uint64_t revision_mark_;
  Cancellation cancellation_;
  std::shared_ptr<SharedArena> arena_;
  std::shared_ptr<SharedInputs> inputs_of_workers_;  ///< from the first one on
};

/// The handle by which calls name an instance.
std::uint64_t handle_of(const Instance& instance);

}  // namespace weft::host
