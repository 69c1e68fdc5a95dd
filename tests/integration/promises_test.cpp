// SPDX-License-Identifier: Apache-2.0
// Runs the repository's pipelines as users do and holds their errors against what is promised.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include "lab/metrics/metrics.hpp"
#include "pipeline/runs/run.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;

class Witness final : public RunObserver {
 public:
  void started(std::int64_t) override {}
  void frame_done(const FrameResult& frame) override {
    states.emplace_back(frame.state, frame.age_frames);
  }

  std::vector<std::pair<ShapeState, std::int64_t>> states;  ///< with the age [frames]
};

class Promises : public ::testing::Test {
 protected:
  Promises() : folder_(fs::temp_directory_path() / ("weft_promises_" + std::to_string(getpid()))) {}
  ~Promises() override { fs::remove_all(folder_); }

  lab::RunMetrics measure(const std::string& pipeline,
                          const std::vector<std::string>& settings = {}) {
    const auto registry = host::Registry::scan(host::search_path({}));
    const auto [checked, report] =
        check_pipeline(WEFT_PIPELINES "/" + pipeline, registry, folder_.string(), settings);
    EXPECT_TRUE(report.ok()) << report.text();
    const std::atomic<bool> cancel{false};
    const auto summary = run_pipeline(checked, folder_.string(), witness_, cancel);
    if (!summary) throw std::runtime_error(summary.error().message);
    EXPECT_EQ(summary->failed, 0);
    const auto metrics = lab::evaluate_run(folder_.string());
    if (!metrics) throw std::runtime_error(metrics.error().message);
    std::cout << pipeline << ": mean " << metrics->all.solved_error.mean_mm << " mm, worst frame "
              << metrics->all.solved_error.worst_mm << " mm\n";
    return *metrics;
  }

  fs::path folder_;
  Witness witness_;
};

/// Pipelines of the same plugins as others here, with sanitizers only slower.
class PromisesOfShapes : public Promises {
 protected:
#if defined(WEFT_SANITIZED)
  void SetUp() override { GTEST_SKIP() << "counts in release alone"; }
#endif
};

TEST_F(Promises, SyntheticSheetIsRecoveredFromTheFirstFrameOn) {
  const auto sparse = measure("sparse.yaml");
  EXPECT_EQ(sparse.counts.frames, 60);
  EXPECT_EQ(sparse.counts.solved(), 60);
  EXPECT_LT(sparse.all.solved_error.mean_mm, 0.7);
  EXPECT_LT(sparse.all.solved_error.worst_mm, 1.5);
}

TEST_F(Promises, TheDefaultPipelineErrsByAQuarterOfAMillimetreAtMost) {
  const auto metrics = measure("demo.yaml", {"source.frames=20"});
  EXPECT_EQ(metrics.counts.solved(), 20);
  EXPECT_LT(metrics.all.solved_error.mean_mm, 0.25);
  EXPECT_LT(metrics.all.solved_error.worst_mm, 0.4);
}

TEST_F(Promises, SheetIsFoundAgainInTheFirstFrameAfterACutOrAGap) {
  const auto metrics = measure("cuts.yaml");
  const std::set<std::size_t> invisible{3, 11, 19, 20, 21, 28, 36, 46, 47, 57};
  ASSERT_EQ(witness_.states.size(), 60U);
  std::int64_t age = 0;
  for (std::size_t i = 0; i < 60; ++i) {
    age = invisible.count(i) > 0 ? age + 1 : 0;
    const auto state = age > 0 ? ShapeState::predicted : ShapeState::estimated;
    EXPECT_EQ(witness_.states[i], std::pair(state, age)) << "frame " << i;
  }
  EXPECT_LT(metrics.all.solved_error.mean_mm, 0.7);
  EXPECT_LT(metrics.all.solved_error.worst_mm, 1.5);
}

TEST_F(PromisesOfShapes, InsoleIsTrackedWithTheTemplateOfItsPhotograph) {
  const auto metrics = measure("outline.yaml");
  EXPECT_EQ(metrics.counts.solved(), 60);
  EXPECT_LT(metrics.all.solved_error.mean_mm, 1.6);
  EXPECT_LT(metrics.all.solved_error.worst_mm, 4.5);
}

TEST_F(PromisesOfShapes, CurvedLabelIsTrackedWithItsSidesOutOfSight) {
  const auto metrics = measure("label.yaml");
  EXPECT_EQ(metrics.counts.solved(), 60);
  EXPECT_LT(metrics.all.solved_error.mean_mm, 1.1);
  EXPECT_LT(metrics.all.solved_error.worst_mm, 2.1);
}

TEST_F(PromisesOfShapes, HalfCylinderIsTrackedWithItsSidesEdgeOn) {
  const auto metrics = measure("half_cylinder.yaml");
  EXPECT_EQ(metrics.counts.solved(), 60);
  EXPECT_LT(metrics.all.solved_error.mean_mm, 2.6);
  EXPECT_LT(metrics.all.solved_error.worst_mm, 4.2);
}

TEST_F(Promises, RealPaperIsRecoveredInEveryFrame) {
  const char* data = std::getenv("WEFT_DATA");
  if (data == nullptr || !fs::exists(fs::path(data) / "kinect_paper")) {
    GTEST_SKIP() << "WEFT_DATA does not name a folder that holds kinect_paper/";
  }
  const auto metrics = measure("kinect_paper.yaml");
  EXPECT_EQ(metrics.counts.frames, 100);
  EXPECT_EQ(metrics.counts.solved(), 100);
  EXPECT_EQ(metrics.all.frames, 16);
  EXPECT_LT(metrics.all.solved_error.mean_mm, 2.2);
  EXPECT_LT(metrics.all.solved_error.worst_mm, 3.5);
  for (const auto& group : metrics.groups) EXPECT_LT(group.solved_error.mean_mm, 2.5) << group.kind;
}

}  // namespace
}  // namespace weft
