// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace weft {

/// What a component warned of, such as a device that is absent.
struct RunWarning {
  std::string component;  ///< "detectors", "filters/warp"
  std::string text;
  std::int64_t frames = 0;  ///< in so many; 0 where it warned before the first frame only
};

}  // namespace weft
