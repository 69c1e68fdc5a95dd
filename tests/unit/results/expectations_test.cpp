// SPDX-License-Identifier: Apache-2.0
#include "lab/results/expectations.hpp"

#include <gtest/gtest.h>

namespace weft::lab {
namespace {

constexpr const char* kMetric = "all.error_solved.mean_mm";

/// Two cells of an axis, `good` and `bad`, both with a figure.
Results two_cells() {
  Results results;
  results.plan.axes = {{"filter", {"good", "bad"}, {}, {}, {}}};
  results.plan.data = {{"all", {"all"}}};
  results.plan.cells = {{0, {"good"}, "all", 1, "a", {}}, {1, {"bad"}, "all", 1, "b", {}}};
  CellRecords records;
  for (const auto& [key, figure] : {std::pair{"a", 1.0}, {"b", 2.0}}) {
    CellRecord& record = records.cells[key];
    record.outcome = CellOutcome::done;
    record.key = key;
    record.figures[kMetric] = figure;
  }
  results.take(std::move(records));
  return results;
}

TEST(Expectations, AreMetByTheMeanOverTheSelectedCells) {
  const Results results = two_cells();
  const ExpectationOutcome both = judge(results, {{}, kMetric, 1.5, 1.5});
  EXPECT_TRUE(both.met);
  EXPECT_EQ(both.cells, 2);
  EXPECT_EQ(both.mean, 1.5);
  EXPECT_TRUE(judge(results, {{{"filter", "good"}}, kMetric, kUnknown, 1.0}).met);
  EXPECT_FALSE(judge(results, {{{"filter", "bad"}}, kMetric, kUnknown, 1.0}).met);
  EXPECT_FALSE(judge(results, {{{"data", "all"}}, kMetric, 1.6, kUnknown}).met);
  EXPECT_TRUE(judge(results, {{{"seed", "1"}, {"sequence", "all"}}, kMetric, 1.0, 2.0}).met);
}

TEST(Expectations, AreMissedByACellThatFailedWhateverWasMeasuredOfIt) {
  Results results = two_cells();
  results.records.cells.at("b").outcome = CellOutcome::failed;
  results.records.cells.at("b").reason = "its process died";
  const ExpectationOutcome outcome = judge(results, {{}, kMetric, kUnknown, 10.0});
  EXPECT_FALSE(outcome.met);
  EXPECT_EQ(outcome.without, 1);
  EXPECT_EQ(outcome.mean, 1.0) << "of the other";
  EXPECT_EQ(outcome.why_not, "a cell failed: its process died");
}

TEST(Expectations, AreMissedByWhatHasNoFigure) {
  Results results = two_cells();
  EXPECT_EQ(judge(results, {{}, "counts.frames", 0.0, kUnknown}).why_not,
            "a cell has no such figure");
  results.records.cells.erase("b");
  EXPECT_EQ(judge(results, {{}, kMetric, 0.0, kUnknown}).why_not, "a cell is not finished");
  const ExpectationOutcome nothing = judge(results, {{{"filter", "none"}}, kMetric, 0.0, kUnknown});
  EXPECT_FALSE(nothing.met);
  EXPECT_EQ(nothing.why_not, "no cell is selected");
}

TEST(Expectations, TellWhichCellsTheySelect) {
  EXPECT_EQ(to_text(Selection{}), "");
  EXPECT_EQ(to_text(Selection{{"filter", "good"}, {"seed", "1"}}), "filter=good, seed=1");
}

}  // namespace
}  // namespace weft::lab
