// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/forecast.hpp"

#include <cmath>

#include "ablation_fixture.hpp"

namespace weft::lab {
namespace {

/// Values a and b of an axis in two sequences. Both cells of a are done.
AblationState half_done() {
  AblationState state;
  PlanRecord& plan = state.results.plan;
  plan.axes = {{"filter", {"a", "b"}, {}, {}, {}}};
  plan.data = {{"sheet", {"sheet_1", "sheet_2"}}};
  plan.sequences = {"sheet_1", "sheet_2"};
  for (const char* value : {"a", "b"}) {
    for (const char* sequence : {"sheet_1", "sheet_2"}) {
      PlanCell& cell = plan.cells.emplace_back();
      cell.values = {value};
      cell.sequence = sequence;
      cell.key = std::string(value) + sequence;
    }
  }
  for (const char* key : {"asheet_1", "asheet_2"}) {
    CellRecord& record = state.results.records.cells[key];
    record.outcome = CellOutcome::done;
    record.key = key;
    record.seconds = 2.0;
  }
  return state;
}

TEST(ForecastOfAnAblation, TakesTheMeanOfTheFinishedCellsForEachMissingOne) {
  const Forecast found = forecast(half_done(), 600.0, 2);
  EXPECT_EQ(found.missing, 2U);
  EXPECT_EQ(found.finished, 2U);
  EXPECT_DOUBLE_EQ(found.seconds_left, 2.0);  // two cells of 2 s, two processes
  EXPECT_DOUBLE_EQ(found.bytes_left, 600.0);
  ASSERT_EQ(found.axes.size(), 2U);
  EXPECT_EQ(found.axes[0].second[0].finished, 2U);
  EXPECT_EQ(found.axes[0].second[1].finished, 0U);
  EXPECT_EQ(found.axes[1].first, "data");
  EXPECT_EQ(found.axes[1].second[0].cells, 4U);
}

TEST(ForecastOfAnAblation, CountsAKeyOnce) {
  AblationState state = half_done();
  state.results.plan.cells[3].key = state.results.plan.cells[2].key;
  EXPECT_EQ(forecast(state, 600.0, 1).missing, 1U);
  EXPECT_DOUBLE_EQ(forecast(state, 600.0, 1).seconds_left, 2.0);
}

TEST(ForecastOfAnAblation, KnowsNoTimeWithoutOne) {
  AblationState state = half_done();
  for (auto& [key, record] : state.results.records.cells) record.seconds = kUnknown;
  EXPECT_TRUE(std::isnan(forecast(state, 600.0, 1).seconds_left));
  state.results.records.cells.clear();
  EXPECT_TRUE(std::isnan(forecast(state, 600.0, 1).bytes_left));
}

class ForecastOfAFolder : public AblationTest {};

TEST_F(ForecastOfAFolder, CountsTheWorkOfCellsWhateverTheTimesOfFilesAre) {
  const std::string sheet = "set: {source.frames: 5, source.sleep_ms: 60}}";
  Grid half =
      expand("axes: {every: {set: filters.every, values: [2, 3]}}\ndata: {one: {" + sheet + "}\n");
  run(half, "out");
  for (const auto& file : fs::directory_iterator(path("out/results"))) {  // as if a clock jumped
    fs::last_write_time(file.path(), fs::file_time_type::clock::now() + std::chrono::hours(99));
  }
  Grid grid = expand("axes: {every: {set: filters.every, values: [2, 3]}}\ndata: {one: {" + sheet +
                     ", two: {set: {source.frames: 6, source.sleep_ms: 60}}}\n");
  const auto state = state_of(grid, *ResultsFolder::look(path("out"), "plan"), {});
  ASSERT_TRUE(state);
  const double seconds = forecast(*state, 0.0, 1).seconds_left;
  EXPECT_GT(seconds, 0.29) << "five frames of 60 ms, shared by two cells";
  EXPECT_LT(seconds, 1000.0);
}

}  // namespace
}  // namespace weft::lab
