// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "cli/commands.hpp"

namespace weft::cli {

struct MutantOptions {
  std::vector<std::string> ids;  ///< of the plugins that are changed; all that can be where empty
  std::uint64_t seed = 1;
  std::size_t count = 60;  ///< at least one of each kind is drawn
  int jobs = 1;
};

/// Makes plugins that are wrong on purpose and lets this program check them. Prints a table.
void check_mutants(const MutantOptions& options, Context& context);

}  // namespace weft::cli
