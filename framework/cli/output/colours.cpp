// SPDX-License-Identifier: Apache-2.0
#include "cli/output/colours.hpp"

#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace weft::cli {

Colours colours_of(std::FILE* stream) {
  const char* refused = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  const bool is_plain = (refused != nullptr && *refused != '\0') || terminal == nullptr ||
                        std::string_view(terminal) == "dumb" || isatty(fileno(stream)) == 0;
  if (is_plain) return {};
  return {"\033[1m", "\033[36m", "\033[1;31m", "\033[0m"};
}

}  // namespace weft::cli
