// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace weft {

/// What somebody at a sink wants of the run: "set PATH=VALUE" as `weft run --set` has it, "pause",
/// "step" (one frame, then pause), "resume" or "stop". The host asks for wishes before each frame,
/// and while frames pause again and again.
struct Wish {
  std::uint64_t number;  ///< the sink's own
  std::string text;
};

/// What became of a wish.
struct WishAnswer {
  std::uint64_t number;
  std::uint64_t frame;  ///< the first one for which it holds, where it is granted
  std::string refusal;  ///< why it is not; empty where it is
};

}  // namespace weft
