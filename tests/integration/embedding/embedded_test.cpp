// SPDX-License-Identifier: Apache-2.0
// A pipeline in a program gives what weft run gives, with real components.
#include "support/embedded.hpp"

#include <gmock/gmock.h>

#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

class Embedded : public testing::PipelineTest {
 protected:
  Embedded() { registry_ = host::Registry::scan({{WEFT_REAL_PLUGINS, "test"}}); }

  void expect_what_a_run_gives(const std::string& name) {
    const std::string file = write(std::string("weft: 1\nextends: " WEFT_PIPELINES "/") + name +
                                   "\nsource: {params: {frames: 4}}\n");
    testing::Ran ran;
    {
      const auto [pipeline, report] = check_pipeline(file, registry_, path("run"));
      ASSERT_TRUE(report.ok()) << report.text();
      ran.summary = run_pipeline(pipeline, path("run"), ran, std::atomic<bool>{false});
      ASSERT_TRUE(ran.summary) << ran.summary.error().message;
    }
    const auto given = testing::InMemory::of(file, registry_);
    auto pipeline = Pipeline::load(file, given.camera, {.plugin_path = {WEFT_REAL_PLUGINS}});
    ASSERT_TRUE(pipeline) << pipeline.error().where << ": " << pipeline.error().message;
    const auto frames = testing::processed(*pipeline, given);
    ASSERT_EQ(frames.size(), 4U);
    EXPECT_EQ(frames.back().state(), ShapeState::estimated);
    testing::expect_same(frames, path("run"));
  }
};

TEST_F(Embedded, TheDemoGivesWhatARunGives) { expect_what_a_run_gives("demo.yaml"); }

TEST_F(Embedded, ATrackerGivesWhatARunGives) { expect_what_a_run_gives("tracked.yaml"); }

}  // namespace
}  // namespace weft
