// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "host/calling/lane.hpp"
#include "host/loading/registry.hpp"
#include "host/records/npz.hpp"
#include "lab/metrics/frame_metrics.hpp"

namespace weft::lab {

/// The frames of a run with the largest errors, and what a picture of them needs.
class WorstFrames {
 public:
  /// `records` are a frame's image, shape and matches, by the slots of a sink; without an image, or
  /// an error, the frame is left out.
  void add(const FrameMetrics& frame, host::NamedRecords records);

  /// File names and contents of pictures, drawn by the sink (see Helpers); none where there is no
  /// such sink or it cannot draw them.
  std::vector<std::pair<std::string, std::string>> draw(const std::string& sink,
                                                        const host::Registry& registry,
                                                        host::Lane& lane,
                                                        const host::RecordPtr& templ,
                                                        const host::RecordPtr& camera) const;

 private:
  struct Frame {
    std::uint64_t index;
    double error_mm;
    host::NamedRecords records;
  };
  std::vector<Frame> frames_;  ///< the worst first
};

}  // namespace weft::lab
