// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "host/loading/registry.hpp"

namespace weft::cli {

/// Lines below `data:` of a plan for what --data names: all that `weft data info` reads, or a
/// folder of several of these. `number` is that of the option.
Result<std::string> compared_data(const std::string& path, std::size_t number,
                                  const host::Registry& registry);

}  // namespace weft::cli
