// SPDX-License-Identifier: Apache-2.0
#include "cli/output/generated_text.hpp"

#include <algorithm>
#include <weft/core/index.hpp>

namespace weft::cli {

void GeneratedText::add(const std::string& lines, const std::string& argument) {
  text_ += lines;
  const auto count = std::count(lines.begin(), lines.end(), '\n');
  arguments_.insert(arguments_.end(), to_index(count), argument.empty() ? otherwise_ : argument);
}

std::string GeneratedText::report_text(const ConfigReport& report, const std::string& file) const {
  std::string text;
  for (const yaml::Problem& problem : report.problems) {
    const bool is_here = report.sources.at(to_index(problem.at.source)).name == file;
    const std::size_t line = to_index(std::max(problem.at.line, 1) - 1);
    const std::string& argument = line < arguments_.size() ? arguments_[line] : otherwise_;
    const std::string place = is_here ? argument : place_in(report.sources, problem.at);
    const bool has_place = !is_here && problem.at.line > 0;
    const std::string said = (has_place ? "" : "error: ") + place + ": " + problem.message + "\n";
    if (text.find(said) == std::string::npos) text += said;  // both pipelines read an argument
  }
  return text;
}

}  // namespace weft::cli
