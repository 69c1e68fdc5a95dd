// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <weft/core/inline_vector.hpp>
#include <weft/core/name.hpp>

#include "host/calling/execution_context.hpp"
#include "host/records/npz.hpp"
#include "pipeline/graph/graph.hpp"

namespace weft {

enum class StageStatus { ok, degenerate, no_result, error, skipped };

const char* to_string(StageStatus status);

/// Numbers by name: counts, scalar diagnostics.
using NamedNumbers = host::PooledVector<std::pair<Name, double>>;

/// The outcome of one stage, or one sink, in one frame.
struct StageReport {
  host::SharedText stage;
  StageStatus status = StageStatus::ok;
  host::SharedText reason;           ///< reason of any status but ok; for skipped the first cause
  host::Spent took;                  ///< nested components included
  NamedNumbers numbers;              ///< counts and scalar diagnostics
  bool shared = false;               ///< taken from another pipeline, see StageMemo
  Errc code = Errc::no_result;       ///< code of an error
  double worker_processor_ms = 0.0;  ///< [] ms in `took` that workers used
};

/// The inputs of the graph in one frame: the source's outputs, or why there are none.
struct FrameInput {
  std::uint64_t index = 0;  ///< [] index of the frame
  host::NamedRecords records;
  std::string failure;               ///< empty when the source could read the frame
  std::uint64_t dropped_before = 0;  ///< frames between the last one and this one, never seen

  /// Null when the source gave no such record.
  host::RecordPtr find(std::string_view slot) const;
};

/// An input of a call.
struct GivenRecord {
  std::string slot;
  host::RecordPtr record;
  std::string
      producer;  ///< producer of a warp: the stage that made it, whose component evaluates it
};

/// One call of a stage: all that went in and came out.
struct StageCall {
  std::string stage;
  std::uint64_t frame = 0;          ///< [] index of the frame
  std::vector<GivenRecord> inputs;  ///< [.] input records
  host::Outcome outcome;
};

struct FrameResult {
  FrameResult() = default;
  /// Its lists are allocated in the pool.
  explicit FrameResult(const std::shared_ptr<host::MemoryPool>& pool)
      : stages(pool), values(pool), causes(pool), timings(pool), setup(pool) {}

  std::uint64_t index = 0;           ///< [] index of the frame
  std::uint64_t place = 0;           ///< frames of this executor that began before it
  std::uint64_t dropped_before = 0;  ///< see FrameInput
  std::string stem;
  host::PooledVector<StageReport> stages;
  host::PooledVector<host::RecordPtr> values;  ///< one for each of Graph::values, null where absent
  host::PooledVector<host::SharedText> causes;  ///< one for each value: why it is absent, if it is
  host::RecordPtr shape;                        ///< solved or predicted; null before the first one
  ShapeState state = ShapeState::none;
  std::int64_t age_frames = 0;   ///< [frames] since the shape was measured
  host::Timings timings;         ///< timings of nested components too
  std::vector<StageCall> calls;  ///< calls of the stages in Executor::keep_calls_of
  NamedNumbers setup;            ///< estimates of the run's set-up
  host::SteadyTime deadline = host::kNoDeadline;  ///< see PipelineConfig::budget_ms
  host::SharedText late_in;  ///< the stage in which the deadline passed; empty if none did
  std::string reason;        ///< why the shape is weak, or less certain than its solver reports
  std::vector<std::string> warnings;  ///< warnings about the set-up, found out by now
  std::vector<std::string> changes;   ///< settings that hold from this frame on

  /// A frame is failed when a stage, the source or a sink had an error; no_result is none.
  bool failed() const;
};

/// The inputs of a call.
using CallInputs = InlineVector<weft_record, 16>;

/// Collects the inputs of a stage or sink; the reason is why a required one is absent, else empty.
host::SharedText gather(const Node& node, const FrameResult& result, CallInputs& inputs);

/// Appends what a reader of frames.jsonl wants of an output: counts, and the scalars that the
/// component calls evidence.
void add_numbers(const host::Record& record, StageReport& report);

/// Status, reason and time of a call as a report; `here` is what this process spent on it.
StageReport report_of(const host::SharedText& stage, const host::Outcome& outcome, host::Spent here,
                      const std::shared_ptr<host::MemoryPool>& pool = nullptr);

}  // namespace weft
