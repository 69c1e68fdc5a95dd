// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/calling/lane.hpp"
#include "pipeline/execution/stage_memo.hpp"
#include "pipeline/graph/graph.hpp"

namespace weft {

/// Makes a component of a pipeline where that says: here or in a process of its own.
Result<host::Instance*> instantiate(host::Lane& lane, const StageConfig& stage,
                                    const host::ComponentSpec& component);

/// Makes stages of a pipeline ready for their first frame.
struct StageMaker {
  host::Lane& lane;
  host::RecordPtr templ, camera;

  /// Instantiates and prepares the component; a detector runs on the template's texture. What was
  /// made until an error is destroyed.
  Result<MadeStage> make(const StageConfig& stage) const;

 private:
  Result<host::Instance*> prepared(const StageConfig& stage,
                                   const host::ComponentSpec& component) const;
  Result<host::RecordPtr> keypoints_by(const StageConfig& stage, host::Instance& instance) const;
  Result<host::RecordPtr> keypoints_of(const StageConfig& stage, host::Instance& instance) const;
};

}  // namespace weft
