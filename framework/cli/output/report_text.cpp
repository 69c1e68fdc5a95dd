// SPDX-License-Identifier: Apache-2.0
#include "cli/output/report_text.hpp"

#include <fmt/core.h>

#include <cstdio>
#include <weft/core/index.hpp>

#include "cli/output/colours.hpp"
#include "cli/output/source_excerpt.hpp"

namespace weft::cli {
namespace {

std::string excerpt_of(const ConfigSource& source, yaml::Position at) {
  if (!source.is_setting) return source_excerpt(source.name, at);
  return source.is_generated ? "" : source_excerpt(source.name, at.column);
}

}  // namespace

std::string problem_text(const std::vector<ConfigSource>& sources, const yaml::Problem& problem) {
  const Colours colours = colours_of(stderr);
  const std::string place = place_in(sources, problem.at);
  if (problem.at.line == 0) {
    return fmt::format("{}error:{} {}: {}\n", colours.error, colours.end, place, problem.message);
  }
  return fmt::format("{}{}:{} {}\n{}", colours.bold, place, colours.end, problem.message,
                     excerpt_of(sources.at(to_index(problem.at.source)), problem.at));
}

void print_report(const ConfigReport& report) {
  for (const yaml::Problem& problem : report.problems) {
    fmt::print(stderr, "{}", problem_text(report.sources, problem));
  }
}

void print_warnings(const ConfigReport& report) {
  for (const auto& [at, message] : report.warnings) {
    const std::string excerpt =
        at.line == 0 ? "" : excerpt_of(report.sources.at(to_index(at.source)), at);
    fmt::print(stderr, "warning: {}: {}\n{}", place_in(report.sources, at), message, excerpt);
  }
}

}  // namespace weft::cli
