// SPDX-License-Identifier: Apache-2.0
#include "pipeline/steering/repeated_frames.hpp"

namespace weft {

Result<RepeatedFrames> RepeatedFrames::of(const RecordedRun& run, const PipelineInput& input) {
  RepeatedFrames repeated;
  repeated.numbers_ = run.frames;
  const std::vector<std::uint64_t>& numbers = repeated.numbers_;
  const auto count = static_cast<std::uint64_t>(input.frames());
  if (input.frames() < 0 || numbers.empty() || numbers.back() < count) return repeated;
  repeated.is_recording_ = numbers.size() == count;
  if (repeated.is_recording_) return repeated;
  return Error{Errc::invalid_value, "the earlier run took " + std::to_string(numbers.size()) +
                                        " frames, the last one " + std::to_string(numbers.back()) +
                                        "; this source has " + std::to_string(count)};
}

std::optional<PipelineInput::Frame> RepeatedFrames::read(std::uint64_t place, PipelineInput& input,
                                                         host::ExecutionContext& context) const {
  if (place >= numbers_.size()) return std::nullopt;
  const std::uint64_t number = numbers_[place];
  const std::uint64_t index = is_recording_ ? place : number;
  auto frame = input.read(index);
  if (!frame) return frame;
  if (index != number) context.times().take(index);  // the report of the source has them
  frame->input.index = number;
  frame->input.dropped_before = number - (place == 0 ? 0 : numbers_[place - 1] + 1);
  return frame;
}

}  // namespace weft
