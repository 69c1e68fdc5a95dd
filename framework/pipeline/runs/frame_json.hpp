// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "pipeline/execution/frame_result.hpp"

namespace weft {

/// Outcome of a frame as one JSON object without a line break: a line of frames.jsonl, where
/// `records` lists the contents of its npz file. Text that is no UTF-8 is replaced.
std::string frame_json(const FrameResult& frame, std::optional<std::size_t> records);

/// Rounded to this number of parts of a whole.
double rounded(double value, double parts);

}  // namespace weft
