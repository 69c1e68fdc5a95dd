// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/execution/executor.hpp"
#include "pipeline/survey/template_faults.hpp"

namespace weft {

/// A pipeline's frame 0 up to its last matches, and their evidence.
struct FirstFrame {
  FirstLook look;
  host::RecordPtr templ, camera, image;
  host::RecordPtr matches;              ///< null where a stage had none
  std::vector<host::RecordPtr> others;  ///< matches of the requested frames behind it
};

/// Runs the stages up to the matches on frame 0, with the original and the mirrored texture. Also
/// runs them on the rest of the first `frames` frames that are readable and have matches.
Result<FirstFrame> look_at_first_frame(const PipelineConfig& config, const Graph& graph,
                                       host::ExecutionContext& context, std::int64_t frames = 1);

}  // namespace weft
