// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/execution/input.hpp"

namespace weft {

/// Settings that are to hold from a frame on, by its number.
using ChangesByFrame = std::map<std::uint64_t, std::vector<std::string>>;

/// Frames and changes of an earlier run, to be repeated.
struct RecordedRun {
  std::vector<std::uint64_t> frames;  ///< their numbers, ascending
  ChangesByFrame changes;
};

/// The frames that an earlier run took, from its source, or from a recording that has these alone:
/// then each is given the number that it had.
class RepeatedFrames {
 public:
  /// Fails where the source is neither.
  static Result<RepeatedFrames> of(const RecordedRun& run, const PipelineInput& input);

  /// The frame at that place in the earlier run; nothing behind its last one.
  std::optional<PipelineInput::Frame> read(std::uint64_t place, PipelineInput& input,
                                           host::ExecutionContext& context) const;

 private:
  std::vector<std::uint64_t> numbers_;
  bool is_recording_ = false;
};

}  // namespace weft
