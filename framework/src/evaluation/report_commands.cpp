// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <weft/evaluation/metrics.hpp>

#include "report_sheets.hpp"

namespace weft::evaluation {
namespace {

/// A path as a shell takes it.
std::string in_shell(const std::string& path) {
  constexpr const char* kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789/._-+=:,@%";
  if (path.find_first_not_of(kPlain) == std::string::npos) return path;
  std::string quoted = "'";
  for (const char c : path) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

std::string anchor_of(std::size_t combination) {
  return "reproduce-" + std::to_string(combination);
}

std::string run_command(const Results& results, const std::string& key) {
  std::string options;
  if (results.alignment != "none") options += " --alignment " + results.alignment;
  if (std::isfinite(results.match_tolerance_px) &&
      results.match_tolerance_px != EvaluationOptions{}.match_tolerance_px) {
    options += fmt::format(" --match-tolerance-px {:g}", results.match_tolerance_px);
  }
  return "weft run " + in_shell(results.folder + "/cells/" + key + "/pipeline.yaml") +
         " --out runs/" + key + " && weft eval runs/" + key + options;
}

std::string command_of(const Results& results, const PlanCell& cell) {
  return run_command(results, cell.key);
}

std::string ablate_command(const Results& results, const std::string& option) {
  return results.command + " --out " + in_shell(results.folder) + option;
}

}  // namespace weft::evaluation
