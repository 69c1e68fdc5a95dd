// SPDX-License-Identifier: Apache-2.0
// Cells that take longer than their plan allows.

#include "ablation_fixture.hpp"

namespace weft::lab {
namespace {

using ::testing::HasSubstr;

class Deadline : public AblationTest {
 protected:
  /// A good cell and another that reads the same frames.
  static std::string beside(const std::string& other, double deadline_s) {
    return "axes: {filter: {values: {good: {}, other: {set: {" + other +
           "}}}}}\ndata: {all: {set: {source.frames: 4}}}\nmetrics: {deadline_s: " +
           std::to_string(deadline_s) + "}\n";
  }
};

TEST_F(Deadline, OfASlowCellEndsItAndLetsItsGroupGoOn) {
  // One call is far from the deadline on a slow machine, two are beyond it on any.
  Grid grid = expand(beside("filters.sleep_ms: 2600", 5.0));
  AblationState state = run(grid, "out");
  EXPECT_EQ(state.done, 1U);
  ASSERT_EQ(state.failed, 1U);
  EXPECT_EQ(cell(grid, state, 1).reason,
            "frame 1: it ran longer than its deadline (deadline_s: 5)");
  EXPECT_EQ(line_of(grid, 1).at("metrics").at("counts").at("frames"), 2);

  state = run(grid, "out");
  EXPECT_EQ(lines("out").size(), 2U) << "it has its result and is not run again";
  AblationOptions retry;
  retry.retry_failed = true;
  Grid patient = expand(beside("filters.sleep_ms: 2600", 60.0));
  EXPECT_EQ(run(patient, "out", 1, retry).done, 2U) << "unless somebody wants it";
}

TEST_F(Deadline, OfACellThatHangsIsItsResultAndCostsNoOther) {
  Grid grid = expand(beside("filters.use: filters/test_deadly, filters.deed: hang", 2.0));
  const AblationState state = run(grid, "out");
  EXPECT_EQ(state.done, 1U);
  ASSERT_EQ(state.failed, 1U) << ::testing::PrintToString(state.reasons);
  EXPECT_EQ(cell(grid, state, 1).reason,
            "it did not end a call within its deadline (deadline_s: 2)");
  EXPECT_THAT(weft::testing::read_text(
                  path("out/cells/" + grid.cells()[1].identity.key + "/pipeline.yaml")),
              HasSubstr("test_deadly"));
}

TEST_F(Deadline, IsNoPartOfWhatACellIs) {
  const Grid without = expand("data: {all: {}}\n");
  const Grid with = expand("data: {all: {}}\nmetrics: {deadline_s: 2}\n");
  EXPECT_EQ(without.cells()[0].identity.key, with.cells()[0].identity.key);
}

}  // namespace
}  // namespace weft::lab
