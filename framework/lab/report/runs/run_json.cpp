// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <nlohmann/json.hpp>
#include <weft/core/shell_word.hpp>

#include "lab/report/runs/run_page.hpp"
#include "lab/report/text/base64.hpp"

namespace weft::lab {
namespace {

using nlohmann::ordered_json;

/// Times of each stage in each frame; 0 where it did not run.
ordered_json stages_json(const RunData& run) {
  std::vector<std::string> names;
  for (const RunFrame& frame : run.frames) {
    for (const StageOutcome& stage : frame.stages) {
      if (std::count(names.begin(), names.end(), stage.stage) == 0) names.push_back(stage.stage);
    }
  }
  ordered_json stages = ordered_json::array();
  for (const std::string& name : names) {
    std::vector<float> ms;
    for (const RunFrame& frame : run.frames) {
      const auto found =
          std::find_if(frame.stages.begin(), frame.stages.end(),
                       [&](const StageOutcome& stage) { return stage.stage == name; });
      ms.push_back(found == frame.stages.end() ? 0.0F : static_cast<float>(found->ms));
    }
    stages.push_back({{"stage", name}, {"ms", packed(ms)}});
  }
  return stages;
}

ordered_json run_json(const RunData& run) {
  std::vector<float> numbers, errors_mm, confidences;
  ordered_json states = ordered_json::array();
  for (const RunFrame& frame : run.frames) {
    numbers.push_back(static_cast<float>(frame.frame));
    errors_mm.push_back(static_cast<float>(frame.mean_mm));
    confidences.push_back(static_cast<float>(frame.confidence));
    states.push_back(frame.state);
  }
  return {{"frames", packed(numbers)},
          {"errors_mm", packed(errors_mm)},
          {"confidences", packed(confidences)},
          {"states", std::move(states)},
          {"stages", stages_json(run)}};
}

ordered_json cell_json(const RunData& run) {
  ordered_json frames = ordered_json::array();
  for (const ViewFrame& frame : run.view.frames) {
    const auto found = std::find_if(run.frames.begin(), run.frames.end(),
                                    [&](const RunFrame& one) { return one.frame == frame.frame; });
    frames.push_back({{"frame", frame.frame},
                      {"state", frame.state},
                      {"mean_mm", found == run.frames.end() ? kUnknown : found->mean_mm},
                      {"vertices", packed(frame.vertices)},
                      {"truth", packed(frame.truth)},
                      {"placed", packed(frame.placed)}});
  }
  return {
      {"name", run.metrics.run},
      {"command", "weft run " + shell_word(run.folder + "/pipeline.yaml") + " --out runs/again"},
      {"faces", base64_of(std::span<const std::uint32_t>(run.view.faces))},
      {"frames", std::move(frames)}};
}

}  // namespace

std::string to_json(const RunData& run) {
  ordered_json object{{"measure", {{"name", "mean 3D error of a frame"}, {"unit", "mm"}}},
                      {"run", run_json(run)}};
  for (const char* list : {"treatments", "sweeps", "scores", "cells"}) {
    object[list] = ordered_json::array();
  }
  if (!run.view.frames.empty()) object["cells"].push_back(cell_json(run));
  return script_safe(object.dump(-1, ' ', true, ordered_json::error_handler_t::replace));
}

}  // namespace weft::lab
