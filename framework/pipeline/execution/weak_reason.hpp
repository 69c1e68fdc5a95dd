// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pipeline/execution/frame_result.hpp"

namespace weft {

/// Why a weak shape, the value of this index, fails the common rule for states, by the evidence
/// that it carries. Empty if it fulfils the rule: then its solver marked it as weak.
std::string weak_reason(const Graph& graph, const FrameResult& result, int value);

}  // namespace weft
