// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace weft {

/// A request of a sink to change a parameter or to control the run. Texts: "set PATH=VALUE" as in
/// `weft run --set`, "save" (the settings, into the run folder), "pause", "step" (one frame, then
/// pause), "resume" or "stop". The host collects requests before each frame and repeatedly while
/// frames are paused.
struct ChangeRequest {
  std::uint64_t number;  ///< identifier that the sink assigns
  std::string text;
};

/// The host's answer to a request.
struct ChangeAnswer {
  std::uint64_t number;  ///< identifier of the request
  std::uint64_t frame;   ///< index of the first frame to which a granted request applies; for
                         ///< "save", N of the file settings-N.yaml
  std::string refusal;   ///< reason of a refusal; empty if the request was granted
};

}  // namespace weft
