// SPDX-License-Identifier: Apache-2.0
#include "cli/run/run_settings.hpp"

#include <filesystem>

namespace weft::cli {

void add_settings(CLI::App& command, std::vector<std::string>& settings) {
  command
      .add_option(
          "--set", settings,
          "PATH=VALUE over the file, such as filters.alpha_s=0.2, detectors.use=detectors/orb "
          "or seed=7; without=NAME leaves a stage or sink out; may be repeated")
      ->option_text("PATH=VALUE")
      ->allow_extra_args(false);
}

void add_without(CLI::App& command, std::vector<std::string>& names) {
  command
      .add_option("--without", names,
                  "Leave out of a plan: AXIS, AXIS.VALUE or data.NAME; may be repeated")
      ->option_text("NAME")
      ->allow_extra_args(false);
}

std::string free_folder(const std::string& pipeline) {
  const std::string base = "runs/" + std::filesystem::path(pipeline).stem().string();
  std::string folder = base;
  for (int i = 2; std::filesystem::exists(folder); ++i) folder = base + "-" + std::to_string(i);
  return folder;
}

}  // namespace weft::cli
