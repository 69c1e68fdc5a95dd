// SPDX-License-Identifier: Apache-2.0
// A detector with its solvers, a tracker that looks back at images, matches without images: with
// real components, several frames at once give the same bytes.
#include "overlapping_pipelines.hpp"

namespace weft {
namespace {

class Overlapping : public testing::OverlappingPipelines {
 protected:
  std::vector<std::string> few_frames(const std::string& pipeline) const override {
    if (pipeline == "matches.yaml") return {};  // it has three
    return {"source.frames=4"};
  }
};

TEST_F(Overlapping, TheDemoGivesTheSameAlsoWithStagesInProcessesOfTheirOwn) {
  expect_the_same("sparse.yaml", {{"frames_at_once=4", "threads=4"},
                                  {"frames_at_once=3", "threads=2", "filters.isolate=process",
                                   "warps.isolate=process"}});
}

TEST_F(Overlapping, ATrackerGivesTheSame) {
  expect_the_same("tracked.yaml", {{"frames_at_once=3", "threads=3"}});
}

TEST_F(Overlapping, MatchesOfFilesGiveTheSame) {
  expect_the_same("matches.yaml", {{"frames_at_once=3", "threads=3"}});
}

}  // namespace
}  // namespace weft
