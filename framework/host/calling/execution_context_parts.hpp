// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <forward_list>
#include <mutex>
#include <optional>
#include <weft/geometry/evidence_count.hpp>

#include "host/calling/execution_context.hpp"
#include "host/roles/role_rules.hpp"
#include "host/workers/worker.hpp"

namespace weft::host {

/// The status that a component returned; any other value is an error.
inline weft_status status_of(std::int32_t status) {
  return status >= WEFT_OK && status <= WEFT_END ? static_cast<weft_status>(status) : WEFT_ERROR;
}

/// A created component, here or in a worker. Destroyed by its library's own function.
class Instance {
 public:
  Instance(const ComponentSpec& spec, std::string in_stage, std::string at_path)
      : id(spec.component().id),
        open_rules(spec.component().open_rules),
        rules(spec.component().rules()),
        produces(spec.component().produces),
        record_types(spec.component().record_types),
        stage(std::move(in_stage)),
        path(std::move(at_path)),
        name(path.empty() ? stage : SharedText(stage + "/" + path)) {}
  ~Instance() { end(); }

  /// Destroys the component; returns its library's fault as a sentence, or an empty text.
  std::string end();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  std::string id;
  std::shared_ptr<const RoleRules> open_rules;  ///< where the role is open, what `rules` are
  const RoleRules& rules;
  std::vector<std::string> produces;
  std::vector<RecordSchema> record_types;  ///< declared by vendors
  SharedText stage;
  std::string path;  ///< nested parameters: "initial_guess/warp"
  SharedText name;   ///< both: "solvers/initial_guess/warp"
  std::uint64_t handle = 0;
  std::uint64_t run_seed = 0;
  const weft_component* table = nullptr;  ///< null where the component lives in a worker
  const weft_device_memory* device_memory =
      nullptr;  ///< where its library keeps arrays, if it does
  void* self = nullptr;
  std::vector<Instance*> nested;
  std::unique_ptr<Worker> worker;         ///< null where it lives here
  std::optional<CreateMessage> recreate;  ///< creates a warp again in workers that may have to
                                          ///< evaluate it
  bool running = false;
  bool is_let_finish = false;  ///< its calls are not cancelled
  EvidenceMemory evidence;     ///< memory for the evidence of its shapes
  bool is_watched = true;  ///< its first call, and each after one that changed the process state
};

/// The answer of a nested component to a call, which lives as long as the call.
struct NestedAnswer {
  Outcome outcome;
  PooledVector<weft_record> views;  ///< views of its records
  ReachableInputs reached{};        ///< behind those of them that had to be fetched
};

/// Announces a call, and its end when it is destroyed.
struct ExecutionContext::Announced {
  Announced(const ExecutionContext& in, const std::string& stage, const std::string& component,
            const std::string& what, std::uint64_t frame)
      : context(in) {
    if (context.announce_) context.announce_(stage, component, what, frame);
  }
  ~Announced() {
    if (context.announce_end_) context.announce_end_();
  }
  Announced(const Announced&) = delete;
  Announced& operator=(const Announced&) = delete;

  const ExecutionContext& context;
};

/// The frame and the draw to which a call belongs.
struct ExecutionContext::Turn {
  std::uint64_t frame, draw;  ///< as in weft_invocation
  std::uint64_t run_frame;    ///< in which it is made: a nested call may be about another one
  int depth;                  ///< [] nesting depth; 0 for a stage
  int threads;                ///< those of its stage
  SteadyTime deadline = kNoDeadline;  ///< deadline of its frame
};

/// The resources that one running call owns.
struct ExecutionContext::Scope {
  ExecutionContext& context;
  Instance& instance;
  const RoleMethod* method;
  Turn turn;
  std::span<const weft_record> inputs{};  ///< as the component gets them
  PooledVector<std::pair<std::string, std::shared_ptr<Record>>> outputs{context.memory_};
  std::forward_list<NestedAnswer, PoolAllocator<NestedAnswer>> nested{context.memory_};
  std::uint64_t downloaded_bytes = 0;  ///< for this call and those nested in it
  double worker_processor_ms = 0.0;    ///< likewise
  std::string refusal{};               ///< reason why the host first refused an array, if it did
  bool has_warned = false;             ///< about a refusal
  std::mutex logging{};                ///< for texts: threads of a call log at the same time
  int texts = 0;                       ///< log messages of this call

  /// True if the role's method may produce this record.
  bool may_produce(std::string_view slot, std::string_view type) const;

  /// True if the component may call `target`: it is nested in it, or made a warp among its inputs
  /// or among the answers that it got.
  bool may_invoke(const Instance& target) const;
};

/// The schema of a record: of the catalogue, or one of `declared`; null if there is none.
const RecordSchema* schema_of(const Record& record, std::span<const RecordSchema> declared);

/// The functions that every call brings; none throws.
const weft_host& host_table();

}  // namespace weft::host
