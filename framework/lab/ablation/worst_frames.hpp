// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "host/calling/execution_context.hpp"
#include "host/loading/registry.hpp"
#include "host/records/npz.hpp"
#include "lab/metrics/frame_metrics.hpp"

namespace weft::lab {

/// The frames of a run with the largest errors, and the data to render them.
class WorstFrames {
 public:
  /// `records` are a frame's image, shape and matches, by the slots of a sink; a frame without an
  /// image, or without an error, is omitted.
  void add(const FrameMetrics& frame, host::NamedRecords records);

  /// File names and contents of images that the sink renders (see Helpers); none if the sink does
  /// not exist or cannot render them.
  std::vector<std::pair<std::string, std::string>> draw(const std::string& sink,
                                                        const host::Registry& registry,
                                                        host::ExecutionContext& context,
                                                        const host::RecordPtr& templ,
                                                        const host::RecordPtr& camera) const;

 private:
  struct Frame {
    std::uint64_t index;  ///< [] index of the frame
    double error_mm;
    host::NamedRecords records;
  };
  std::vector<Frame> frames_;  ///< the worst first
};

}  // namespace weft::lab
