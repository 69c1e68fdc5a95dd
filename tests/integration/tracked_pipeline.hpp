// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "lab/metrics/metrics.hpp"
#include "pipeline/runs/run.hpp"

namespace weft::testing {

/// pipelines/tracked.yaml, run and measured.
class TrackedPipeline : public ::testing::Test {
 protected:
  /// The recorded part of a frame's result.
  struct Seen {
    ShapeState state;
    StageStatus tracked;
    bool is_detected;    ///< the detector was called
    std::string reason;  ///< reason of the stage `tracked`
  };

  class Witness final : public RunObserver {
   public:
    void started(std::int64_t) override {}
    void frame_done(const FrameResult& frame) override {
      Seen seen{frame.state, StageStatus::skipped, false, {}};
      for (const StageReport& report : frame.stages) {
        if (report.stage == "tracked") seen.tracked = report.status;
        if (report.stage == "tracked") seen.reason = report.reason;
        if (report.stage == "detectors") seen.is_detected = report.status != StageStatus::skipped;
      }
      frames.push_back(seen);
    }
    std::vector<Seen> frames;
  };

  TrackedPipeline()
      : folder_(std::filesystem::temp_directory_path() /
                ("weft_tracked_" + std::to_string(getpid()))) {}
  ~TrackedPipeline() override { std::filesystem::remove_all(folder_); }

  /// Runs the pipeline without the sinks that only write; `text` overrides the pipeline.
  lab::RunMetrics measure(const std::string& pipeline, const std::string& text) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    const std::string file = (folder_ / "pipeline.yaml").string();
    std::ofstream(file) << "weft: 1\nextends: " WEFT_PIPELINES "/" << pipeline
                        << "\nwithout: [overlay, meshes]\n"
                        << text;
    const auto registry = host::Registry::scan(host::search_path({}));
    const std::string out = (folder_ / "run").string();
    const auto [checked, report] = check_pipeline(file, registry, out);
    EXPECT_TRUE(report.ok()) << report.text();
    const std::atomic<bool> cancel{false};
    witness_.frames.clear();
    const auto summary = run_pipeline(checked, out, witness_, cancel);
    if (!summary) throw std::runtime_error(summary.error().message);
    EXPECT_EQ(summary->failed, 0);
    const auto metrics = lab::evaluate_run(out);
    if (!metrics) throw std::runtime_error(metrics.error().message);
    std::cout << pipeline << ": mean " << metrics->all.solved_error.mean_mm << " mm, worst frame "
              << metrics->all.solved_error.worst_mm << " mm, detected in " << detected() << " of "
              << witness_.frames.size() << " frames\n";
    return *metrics;
  }

  std::int64_t detected() const {
    return std::count_if(witness_.frames.begin(), witness_.frames.end(),
                         [](const Seen& frame) { return frame.is_detected; });
  }

  std::filesystem::path folder_;
  Witness witness_;
};

}  // namespace weft::testing
