// SPDX-License-Identifier: Apache-2.0
#include "cli/shell/coloured_help.hpp"

#include <algorithm>
#include <sstream>

namespace weft::cli {

std::string coloured_help(const std::string& help, const Colours& colours) {
  if (colours.end.empty()) return help;
  std::string text;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line); text += '\n') {
    const std::size_t first = line.find_first_not_of(' ');
    if (first == 2) {
      const std::size_t end = std::min(line.find("  ", first), line.size());
      text += "  " + colours.accent + line.substr(2, end - 2) + colours.end + line.substr(end);
    } else if (first == 0 && line.ends_with(':')) {
      text += colours.bold + line + colours.end;
    } else {
      text += line;
    }
  }
  return text;
}

}  // namespace weft::cli
