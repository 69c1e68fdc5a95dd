// SPDX-License-Identifier: Apache-2.0
#include "cli/output/generated_text.hpp"

#include <algorithm>
#include <weft/core/index.hpp>

#include "cli/output/report_text.hpp"

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
    const std::string said = is_here ? "error: " + argument + ": " + problem.message + "\n"
                                     : problem_text(report.sources, problem);
    if (text.find(said) == std::string::npos) text += said;  // both pipelines read an argument
  }
  return text;
}

}  // namespace weft::cli
