// SPDX-License-Identifier: Apache-2.0
#include "cli/output/outcome.hpp"

#include <fmt/core.h>

#include <cstdio>
#include <string>
#include <weft/core/quote.hpp>

namespace weft::cli {

void print_error(const Error& error) {
  const std::string line = fmt::format("error: {}{}{}\n", escaped(error.where),
                                       error.where.empty() ? "" : ": ", error.message);
  std::fputs(line.c_str(), stderr);  // this failure cannot be reported any more
}

}  // namespace weft::cli
