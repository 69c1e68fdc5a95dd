// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace weft {

/// A warning of a component, such as an absent device.
struct RunWarning {
  std::string component;  ///< "detectors", "filters/warp"
  std::string text;
  std::int64_t frames =
      0;  ///< number of frames with it; 0 if it warned before the first frame only
};

}  // namespace weft
