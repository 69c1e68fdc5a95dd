// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/calling/execution_context.hpp"
#include "pipeline/execution/stage_memo.hpp"
#include "pipeline/graph/graph.hpp"

namespace weft {

/// Makes a component of a pipeline in the configured process: here or in a worker.
Result<host::Instance*> instantiate(host::ExecutionContext& context, const StageConfig& stage,
                                    const host::ComponentSpec& component);

/// Makes stages of a pipeline ready for their first frame.
struct StageMaker {
  host::ExecutionContext& context;
  host::RecordPtr templ, camera;

  /// Instantiates and prepares the component; a detector runs on the template's texture. On an
  /// error, everything made so far is destroyed.
  Result<MadeStage> make(const StageConfig& stage) const;

 private:
  Result<host::Instance*> prepared(const StageConfig& stage,
                                   const host::ComponentSpec& component) const;
  Result<host::RecordPtr> keypoints_by(const StageConfig& stage, host::Instance& instance) const;
  Result<host::RecordPtr> keypoints_of(const StageConfig& stage, host::Instance& instance) const;
};

}  // namespace weft
