// SPDX-License-Identifier: Apache-2.0
#include "cli/wiring/measured_times.hpp"

#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>
#include <weft/core/statistics.hpp>
#include <weft/core/text_file.hpp>

#include "lab/metrics/runs/json_file.hpp"

namespace weft::cli {
namespace {

using TimesMs = std::map<std::string, std::vector<double>>;

/// Times of all frames by the name of the stage or sink; the source is "sources".
Result<TimesMs> read_times(const std::string& folder) {
  if (auto found = check_input(folder, InputKind::folder, "give the folder of a run"); !found) {
    return found.error();
  }
  const std::string file = folder + "/frames.jsonl";
  const auto text = read_text_file(file, lab::kMostJsonBytes);
  if (!text) return Error{Errc::io, unreadable_text(text.error()), file};
  TimesMs times;
  std::istringstream lines(*text);
  std::size_t number = 1;
  for (std::string line; std::getline(lines, line); ++number) {
    if (lines.eof()) break;  // the run was cut off in this line
    try {
      const nlohmann::json frame = nlohmann::json::parse(line);
      for (const nlohmann::json& stage : frame.at("stages")) {
        if (stage.at("status") == "skipped") continue;
        times[stage.at("stage")].push_back(stage.at("ms").get<double>());
      }
    } catch (const nlohmann::json::exception& mistake) {
      return Error{Errc::syntax, lab::reason_of(mistake), file + ":" + std::to_string(number)};
    }
  }
  return times;
}

}  // namespace

Result<std::map<std::string, double>> measured_times_ms(const PipelineConfig& config,
                                                        const std::string& run_folder) {
  const auto times = read_times(run_folder);
  if (!times) return times.error();
  std::map<std::string, double> medians;
  const auto add = [&](const std::string& name, const std::string& timed) {
    const auto found = times->find(timed);
    if (found != times->end()) medians[name] = median(found->second);
  };
  for (const StageConfig& stage : config.stages) add(stage.name, stage.name);
  if (medians.empty()) {
    return Error{Errc::invalid_value,
                 "no stage of this pipeline has run in it; give a run of the pipeline", run_folder};
  }
  add("source", "sources");
  for (const StageConfig& sink : config.sinks) add(sink.name, sink.name);
  return medians;
}

}  // namespace weft::cli
