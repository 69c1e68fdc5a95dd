// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace weft::testing {

/// A line of frames.jsonl without what depends on the clock.
inline nlohmann::json timeless_line(const std::string& line) {
  nlohmann::json frame = nlohmann::json::parse(line);
  for (const char* times : {"ms", "processor_ms"}) {
    frame.erase(times);
    for (nlohmann::json& stage : frame["stages"]) stage.erase(times);
  }
  return frame;
}

/// frames.jsonl of a run without what depends on the clock.
inline std::vector<nlohmann::json> timeless(const std::string& run_folder) {
  std::vector<nlohmann::json> frames;
  std::ifstream lines(run_folder + "/frames.jsonl");
  for (std::string line; std::getline(lines, line);) frames.push_back(timeless_line(line));
  return frames;
}

}  // namespace weft::testing
