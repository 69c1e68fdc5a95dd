// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <weft/core/shell_word.hpp>

#include "lab/metrics/metrics.hpp"
#include "lab/report/sheets.hpp"

namespace weft::lab {

std::string anchor_of(std::size_t combination) {
  return "reproduce-" + std::to_string(combination);
}

namespace {

/// "weft", with the folders of plugins that the ablation was given.
std::string program_of(const Results& results) {
  const std::string& command = results.plan.command;
  const std::size_t end = command.find(" ablate ");
  return end == std::string::npos ? "weft" : command.substr(0, end);
}

}  // namespace

std::string run_command(const Results& results, const std::string& key) {
  std::string options;
  if (results.alignment != "none") options += " --alignment " + results.alignment;
  if (std::isfinite(results.match_tolerance_px) &&
      results.match_tolerance_px != EvaluationOptions{}.match_tolerance_px) {
    options += fmt::format(" --match-tolerance-px {:g}", results.match_tolerance_px);
  }
  const std::string run = shell_word("runs/" + key);
  return program_of(results) + " run " +
         shell_word(results.folder + "/cells/" + key + "/pipeline.yaml") + " --out " + run +
         " && weft eval " + run + options;
}

std::string command_of(const Results& results, const PlanCell& cell) {
  return run_command(results, cell.key);
}

std::string ablate_command(const Results& results, const std::string& option) {
  return results.plan.command + " --out " + shell_word(results.folder) + option;
}

}  // namespace weft::lab
