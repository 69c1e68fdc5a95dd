// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "host/calling/execution_context.hpp"
#include "host/roles/role_rules.hpp"
#include "pipeline/execution/compose.hpp"
#include "pipeline/execution/frame_line.hpp"
#include "pipeline/execution/frame_result.hpp"
#include "pipeline/execution/history.hpp"
#include "pipeline/execution/stage_memo.hpp"

namespace weft {

/// Runs the stages of a wired pipeline, frame by frame.
class Executor {
 public:
  /// Instantiates and prepares all stages and runs the detectors on the template. Stages that share
  /// a key with another pipeline of this execution context are made, and run in each frame, only
  /// once.
  static Result<std::unique_ptr<Executor>> create(const PipelineConfig& config, const Graph& graph,
                                                  host::ExecutionContext& context,
                                                  host::RecordPtr templ, host::RecordPtr camera,
                                                  Sharing sharing = {});

  /// From the next frame on, this component replaces the stage of that index. A StageMaker made it
  /// for a configuration that differs in parameters alone. The old component is destroyed when no
  /// frame needs it any more. Call from the thread that begins frames.
  void change(std::size_t stage, std::shared_ptr<const StageConfig> config, MadeStage made);

  /// From now on frames hold what goes into this stage and comes out of it.
  void keep_calls_of(const std::string& stage);

  FrameResult process(const FrameInput& input);

  /// The same in steps, for frames that overlap: `begin`, `run_stage` of each stage in turn, `end`.
  /// The steps of a frame run one after another, and each of them one frame after another; `rules`
  /// has all other conditions. From any thread.
  FrameResult begin(const FrameInput& input);
  void run_stage(std::size_t stage, FrameResult& result);
  void end(FrameResult& result);

  /// One a stage; behind the stages come the end of the frame and the sinks.
  std::vector<StepRule> rules() const;

  /// The next frame is the first of a sequence: nothing is fed back to it. State that components
  /// keep for speed stays.
  void restart();

 private:
  struct Change {
    std::uint64_t place;  ///< number of the first frame for which it holds
    std::shared_ptr<const StageConfig> config;
    MadeStage made;
  };
  struct Stage {
    std::shared_ptr<const StageConfig> config;
    const Node* node;
    const RoleRules& rules;
    MadeStage made;
    std::string key;  ///< for the memo
    MatchPlacer placer;
    host::SharedText name;
    host::SharedText not_called;        ///< why, in all frames in which its rule does not hold
    host::SharedText not_called_cause;  ///< the same as the cause for stages that read its outputs
    bool is_kept = false;               ///< its calls are
    std::deque<Change> changes{};       ///< to come
  };

  Executor(const PipelineConfig& config, const Graph& graph, host::ExecutionContext& context,
           host::RecordPtr templ, host::RecordPtr camera, Sharing sharing);
  Stage stage_of(std::size_t index, MadeStage made) const;
  void change_until(std::uint64_t place, Stage& stage);
  Result<MadeStage> made_stage(const StageConfig& stage, const std::string& key);
  void place_given(const FrameInput& input, FrameResult& result) const;
  void place_past(std::size_t value, FrameResult& result) const;
  std::size_t steps_to_last_user_of_warp(std::size_t stage) const;
  void keep_call(const Stage& stage, const host::Outcome& outcome, FrameResult& result) const;
  static bool is_called(const Stage& stage, const FrameResult& result);
  StageReport answer(Stage& stage, FrameResult& result);
  StageReport execute(Stage& stage, FrameResult& result);
  static StageAnswer answer_of(const Stage& stage, StageReport report, const FrameResult& result);
  static StageReport take(const StageAnswer& answer, const Stage& stage, FrameResult& result);
  Result<host::PooledVector<host::RecordPtr>> outputs_of(const Stage& stage,
                                                         const host::Outcome& outcome,
                                                         const FrameResult& result);
  Result<void> store(Stage& stage, const host::Outcome& outcome, FrameResult& result);
  void settle_shape(FrameResult& result);

  const PipelineConfig& config_;
  const Graph& graph_;
  host::ExecutionContext& context_;
  host::RecordPtr template_;
  host::RecordPtr camera_;
  Points vertices_;  ///< where warps are sampled
  Sharing sharing_;
  std::vector<Stage> stages_;
  std::vector<host::SharedText> absent_;  ///< why a value is, one for each, of what is no stage's
  History history_;
  std::uint64_t begun_ = 0;  ///< [frames]
  mutable std::mutex
      changes_mutex_;  ///< guards changes of stages, for other threads than their own
  std::int64_t frames_since_measured_ = 0;
};

}  // namespace weft
