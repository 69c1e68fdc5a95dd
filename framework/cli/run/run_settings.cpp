// SPDX-License-Identifier: Apache-2.0
#include "cli/run/run_settings.hpp"

#include <algorithm>
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
                  "Omit from a plan: AXIS, AXIS.VALUE or data.NAME; may be repeated")
      ->option_text("NAME")
      ->allow_extra_args(false);
}

void add_isolation(CLI::App& command, std::string& choice) {
  command
      .add_option("--isolate", choice,
                  "Components that run in a separate process unless the pipeline specifies it: "
                  "auto: plugins from other folders than the program's, unless they keep data on a "
                  "device; none; all")
      ->check(CLI::IsMember({"auto", "none", "all"}))
      ->option_text("auto|none|all [auto]");
}

Isolating isolating_of(const std::string& choice) {
  if (choice == "none") return Isolating::none;
  return choice == "all" ? Isolating::all : Isolating::automatic;
}

std::string words_on_isolation(const PipelineConfig& config) {
  std::vector<std::string> isolated;
  const auto look = [&](const StageConfig& stage) {
    const std::string& id = stage.component.component().id;
    const bool is_new = std::find(isolated.begin(), isolated.end(), id) == isolated.end();
    if (stage.isolated_by_default && is_new) isolated.push_back(id);
  };
  for (const auto* single : {&config.source, &config.templ}) look(**single);
  for (const auto* list : {&config.stages, &config.sinks}) {
    std::for_each(list->begin(), list->end(), look);
  }
  if (isolated.empty()) return {};
  std::string names = isolated.front();
  for (std::size_t i = 1; i < isolated.size(); ++i) {
    names += (i + 1 < isolated.size() ? ", " : " and ") + isolated[i];
  }
  return names + (isolated.size() > 1
                      ? " run in separate processes (--isolate none runs them here)"
                      : " runs in a separate process (--isolate none runs it here)");
}

std::string free_folder(const std::string& pipeline) {
  return free_beside("runs/" + std::filesystem::path(pipeline).stem().string());
}

std::string free_beside(const std::string& base) {
  std::string folder = base;
  for (int i = 2; std::filesystem::exists(folder); ++i) folder = base + "-" + std::to_string(i);
  return folder;
}

bool ClaimedFolder::take(const std::string& folder) {
  namespace fs = std::filesystem;
  constexpr int kTries = 100;  // another run may remove `runs` in between
  const std::string parent = fs::path(folder).parent_path().string();
  std::error_code code = std::make_error_code(std::errc::no_such_file_or_directory);
  for (int i = 0; i < kTries && code == std::errc::no_such_file_or_directory; ++i) {
    if (fs::create_directory(parent, code)) made_ = {parent};
    if (fs::create_directory(folder, code)) {
      made_.insert(made_.begin(), folder);
      return true;
    }
  }
  return static_cast<bool>(code) && !fs::exists(folder, code);
}

ClaimedFolder::~ClaimedFolder() {
  std::error_code code;
  for (const std::string& folder : made_) std::filesystem::remove(folder, code);
}

}  // namespace weft::cli
