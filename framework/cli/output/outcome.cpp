// SPDX-License-Identifier: Apache-2.0
#include "cli/output/outcome.hpp"

#include <fmt/core.h>

#include <cstdio>
#include <string>
#include <weft/core/quote.hpp>

#include "cli/output/colours.hpp"
#include "cli/output/source_excerpt.hpp"

namespace weft::cli {

void print_error(const Error& error) {
  const Colours colours = colours_of(stderr);
  const std::string text =
      fmt::format("{}error:{} {}{}{}\n{}", colours.error, colours.end, escaped(error.where),
                  error.where.empty() ? "" : ": ", error.message, source_excerpt(error.where));
  std::fputs(text.c_str(), stderr);  // this failure cannot be reported any more
}

}  // namespace weft::cli
