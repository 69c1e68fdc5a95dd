// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "host/records/content_hash.hpp"
#include "lab/ablation/ablation.hpp"
#include "lab/metrics/forms/metrics_report.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::lab {

namespace fs = std::filesystem;
using nlohmann::json;

/// Runs plans over the base of the folder of plans.
class AblationTest : public weft::testing::PipelineTest {
 protected:
  AblationTest()
      : registry_of_all_(
            host::Registry::scan({{WEFT_TEST_PLUGINS, "test"}, {WEFT_DEADLY_FOLDER, "test"}})) {}

  std::string write_plan(const std::string& rest) const {
    return write("weft: 1\nname: plan\npipeline: " + std::string(WEFT_PLANS) +
                     "/base.yaml\ndata_use: tuning\n" + rest,
                 "plan.yaml");
  }

  Grid expand(const std::string& rest) const {
    auto [plan, report] = read_plan(write_plan(rest), registry_of_all_);
    EXPECT_TRUE(report.ok()) << report.text();
    auto [grid, mistakes] = Grid::expand(std::move(plan), registry_of_all_, {});
    EXPECT_TRUE(mistakes.ok()) << mistakes.text();
    return std::move(grid);
  }

  /// Runs what has no result yet, until the share of it that is done.
  AblationState run(Grid& grid, const std::string& out, int jobs = 1,
                    const AblationOptions& options = {}, double until = 2.0) const {
    const auto folder = ResultsFolder::open(path(out), "plan");
    EXPECT_TRUE(folder) << (folder ? "" : folder.error().message);
    // A run that stops before its first cell must not depend on when progress is reported.
    std::atomic<bool> cancel{until < 0.0};
    auto state = run_ablation(
        grid, *folder, *local_engine(jobs), options,
        [&](double share) { cancel = cancel || share >= until; }, cancel);
    EXPECT_TRUE(state) << (state ? "" : state.error().message);
    return *std::move(state);
  }

  std::vector<json> lines(const std::string& out) const {
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(path(out + "/results"))) {
      files.push_back(entry.path().string());
    }
    std::sort(files.begin(), files.end());
    std::vector<json> all;
    for (const std::string& file : files) {
      for (const std::string& line : weft::testing::read_lines(file)) {
        all.push_back(json::parse(line));
      }
    }
    return all;
  }

  static const CellRecord& cell(const Grid& grid, const AblationState& state, std::size_t index) {
    return state.results.records.cells.at(grid.cells()[index].identity.key);
  }

  /// The line of a cell in the folder "out".
  json line_of(const Grid& grid, std::size_t index) const {
    const std::vector<json> all = lines("out");
    const auto found = std::find_if(all.begin(), all.end(), [&](const json& line) {
      return line.at("key") == grid.cells()[index].identity.key;
    });
    return found == all.end() ? json() : *found;
  }

  /// A line with its check made anew after a change.
  static std::string checked_again(std::string line) {
    constexpr std::size_t kCheck = sizeof(",\"check\":\"\"}") - 1 + 32;
    line = line.substr(0, line.size() - kCheck) + "}";
    const std::string check = host::content_hash(line);
    return line.substr(0, line.size() - 1) + ",\"check\":\"" + check + "\"}";
  }

  /// All that is promised to be the same, sorted; each key may have one line only.
  std::string results(const std::string& out) const {
    std::map<std::string, std::string> by_key;
    for (json line : lines(out)) {
      line.erase("timing");
      line.erase("machine");
      line.erase("check");  // it covers these two
      const std::string key = line.at("key");
      EXPECT_TRUE(by_key.emplace(key, line.dump()).second) << "two lines of " << key;
    }
    std::string text = weft::testing::read_text(path(out + "/plan.json"));
    for (const auto& [key, line] : by_key) {
      text += line + "\n" + weft::testing::read_text(path(out + "/cells/" + key + "/shapes.npz")) +
              weft::testing::read_text(path(out + "/cells/" + key + "/pipeline.yaml"));
    }
    return text;
  }

  host::Registry registry_of_all_;
};

/// Two sequences, eight pipelines, two run seeds that only half of them look at.
inline const char* const kGrid =
    "axes:\n"
    "  filter:\n"
    "    values:\n"
    "      none: {without: [filters]}\n"
    "      every: {set: {filters.every: 3}}\n"
    "      chance: {set: {filters.use: filters/test.random}}\n"
    "      off: {set: {filters.error_at: [0, 1, 2, 3, 4]}}\n"
    "  solver: {set: solvers.distance_m, values: [0.2, 0.3]}\n"
    "data: {plain: {seeds: 3-4, seed_setting: source.frames}}\n"
    "seeds: 1-2\n";

}  // namespace weft::lab
