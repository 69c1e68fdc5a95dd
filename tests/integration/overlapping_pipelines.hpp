// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "pipeline/runs/run.hpp"
#include "support/run_lines.hpp"

namespace weft::testing {

/// Runs pipelines of this repository with several frames at once against one after another.
class OverlappingPipelines : public ::testing::Test {
 protected:
  /// Files of a run folder by name, and their content without times and settings.
  using Contents = std::map<std::string, std::string>;

  OverlappingPipelines() : registry_(host::Registry::scan(host::search_path({}))) {
    std::string pattern = (std::filesystem::temp_directory_path() / "weft-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~OverlappingPipelines() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  /// The settings that leave few frames of a pipeline.
  virtual std::vector<std::string> few_frames(const std::string& pipeline) const = 0;

  /// Each of `settings`, such as "frames_at_once=4", gives the run folder that there is with one
  /// thread and one frame after another.
  void expect_the_same(const std::string& pipeline,
                       const std::vector<std::vector<std::string>>& settings) const {
    const Contents serial = run(pipeline, {"frames_at_once=1", "threads=1"});
    ASSERT_GT(serial.size(), 3U) << "the pipeline has not run";
    for (const std::vector<std::string>& each : settings) {
      std::string text;
      for (const std::string& setting : each) text += setting + " ";
      SCOPED_TRACE(text);
      const Contents other = run(pipeline, each);
      for (const auto& [name, content] : serial) {
        const auto found = other.find(name);
        ASSERT_NE(found, other.end()) << name << " is missing";
        // EXPECT_EQ would print the bytes of a video.
        EXPECT_TRUE(found->second == content)
            << name << " differs" << (name == "frames.jsonl" ? ":\n" + found->second : "");
      }
      EXPECT_EQ(other.size(), serial.size());
    }
  }

  /// The names of the stages of a pipeline, in their order.
  std::vector<std::string> stages_of(const std::string& pipeline) const {
    std::vector<std::string> names;
    const auto [config, report] = load_pipeline(file_of(pipeline), registry_, folder_);
    for (const StageConfig& stage : config.stages) names.push_back(stage.name);
    return names;
  }

  static std::string file_of(const std::string& pipeline) { return WEFT_PIPELINES "/" + pipeline; }

  host::Registry registry_;
  std::string folder_;

 private:
  struct Silent final : RunObserver {
    void started(std::int64_t) override {}
    void frame_done(const FrameResult&) override {}
  };

  Contents run(const std::string& pipeline, std::vector<std::string> settings) const {
    const std::vector<std::string> few = few_frames(pipeline);
    settings.insert(settings.end(), few.begin(), few.end());
    const std::string out = folder_ + "/run";
    std::filesystem::remove_all(out);
    auto [checked, report] = check_pipeline(file_of(pipeline), registry_, out, settings);
    EXPECT_TRUE(report.ok()) << report.text();
    if (!report.ok()) return {};
    for (StageConfig& stage : checked.config.stages) {
      if (stage.isolation) stage.isolation->program = WEFT_WORKER;
    }
    Silent silent;
    const std::atomic<bool> cancel{false};
    const auto summary = run_pipeline(checked, out, silent, cancel);
    EXPECT_TRUE(summary) << summary.error().where << ": " << summary.error().message;
    if (!summary) return {};
    EXPECT_GT(summary->frames, 2);
    EXPECT_LE(summary->frames, 12) << "limit them in few_frames()";
    return contents_of(out);
  }

  static Contents contents_of(const std::string& out) {
    Contents contents;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(out)) {
      if (!entry.is_regular_file()) continue;
      std::ifstream stream(entry.path(), std::ios::binary);
      contents[std::filesystem::relative(entry.path(), out).string()] = {
          std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    }
    contents.erase("trace.json");     // times, and which process is which
    contents.erase("pipeline.yaml");  // has the settings to compare; so do "sources"
    auto manifest = nlohmann::json::parse(contents["manifest.json"]);
    manifest.erase("sources");
    contents["manifest.json"] = manifest.dump();
    std::string lines;
    for (const nlohmann::json& line : timeless(out)) lines += line.dump() + "\n";
    contents["frames.jsonl"] = lines;
    return contents;
  }
};

}  // namespace weft::testing
