// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/runs/run.hpp"

namespace weft::testing {

/// A pipeline of the scripted components; parameters are YAML, by role, "{}" where not given.
inline std::string chain(const std::map<std::string, std::string>& params = {},
                         const std::string& options = "") {
  const auto component = [&](const std::string& role) {
    const auto found = params.find(role);
    return "{use: " + role +
           "/test.scripted, params: " + (found == params.end() ? "{}" : found->second) + "}\n";
  };
  std::string text = "weft: 1\n" + options + (options.empty() ? "" : "\n");
  text += "source: " + component("sources") + "template: " + component("templates") + "stages:\n";
  for (const char* role : {"detectors", "matchers", "filters", "warps", "passes", "solvers"}) {
    text += "  - " + component(role);
  }
  return text + "sinks:\n  - " + component("sinks");
}

/// The beginning of a pipeline with the scripted source and template.
inline std::string head(const std::string& source_params = "{}") {
  return "weft: 1\nsource: {use: sources/test.scripted, params: " + source_params +
         "}\ntemplate: {use: templates/test.scripted}\n";
}

/// "line:column: message" of each error.
inline std::vector<std::string> lines(const ConfigReport& report) {
  std::vector<std::string> result;
  for (const yaml::Problem& problem : report.problems) {
    result.push_back(std::to_string(problem.at.line) + ":" + std::to_string(problem.at.column) +
                     ": " + problem.message);
  }
  return result;
}

inline std::string read_text(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

inline std::vector<std::string> read_lines(const std::string& file) {
  std::ifstream stream(file);
  std::vector<std::string> result;
  for (std::string line; std::getline(stream, line);) result.push_back(line);
  return result;
}

/// A run with all its frames.
struct Ran : RunObserver {
  Result<RunSummary> summary = Error{};
  std::int64_t announced = -2;
  std::vector<FrameResult> frames;
  std::string folder;

  void started(std::int64_t count) override { announced = count; }
  void frame_done(const FrameResult& frame) override { frames.push_back(frame); }

  const StageReport& report(std::size_t frame, const std::string& stage) const {
    static const StageReport kNone{"no such stage", StageStatus::skipped, "", {}, {}, false};
    if (frame >= frames.size()) return kNone;
    for (const StageReport& each : frames[frame].stages) {
      if (each.stage == stage) return each;
    }
    return kNone;
  }
  /// "ok", or "no_result: reason".
  std::string status(std::size_t frame, const std::string& stage) const {
    const StageReport& each = report(frame, stage);
    return to_string(each.status) + (each.reason.empty() ? "" : ": " + each.reason);
  }
  double number(std::size_t frame, const std::string& stage, const std::string& name) const {
    for (const auto& [key, value] : report(frame, stage).numbers) {
      if (key == name) return value;
    }
    return std::numeric_limits<double>::quiet_NaN();
  }
  /// "estimated predicted/1 lost/2": states, with the age where it is not 0.
  std::string states() const {
    std::string text;
    for (const FrameResult& frame : frames) {
      text += (text.empty() ? "" : " ") + std::string(to_string(frame.state));
      if (frame.age_frames != 0) text += "/" + std::to_string(frame.age_frames);
    }
    return text;
  }
};

/// A folder for each test, and the scripted components.
class PipelineTest : public ::testing::Test {
 protected:
  PipelineTest() : registry_(host::Registry::scan({{WEFT_TEST_PLUGINS, "test"}})) {
    std::string pattern = (std::filesystem::temp_directory_path() / "weft-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~PipelineTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::string path(const std::string& name) const { return folder_ + "/" + name; }

  std::string write(const std::string& text, const std::string& name = "pipeline.yaml") const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }

  std::pair<PipelineConfig, ConfigReport> load(const std::string& text) const {
    return load_pipeline(write(text), registry_, path("run"));
  }

  std::pair<CheckedPipeline, ConfigReport> check(const std::string& text) const {
    return check_pipeline(write(text), registry_, path("run"));
  }

  Ran run(const std::string& text, const std::string& out = "run") const {
    Ran ran;
    ran.folder = path(out);
    const auto [pipeline, report] = check_pipeline(write(text), registry_, ran.folder);
    EXPECT_TRUE(report.ok()) << report.text();
    const std::atomic<bool> cancel{false};
    if (report.ok()) ran.summary = run_pipeline(pipeline, ran.folder, ran, cancel);
    return ran;
  }

  host::Registry registry_;
  std::string folder_;
};

}  // namespace weft::testing
