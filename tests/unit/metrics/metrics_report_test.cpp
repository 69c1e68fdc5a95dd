// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/forms/metrics_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "test_run.hpp"

namespace weft::lab {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

/// A frame of each sort.
void fill(TestRun& run) {
  run.add(ShapeState::none, std::nullopt, TestRun::truth("mdh"));
  run.solved(2.0, TestRun::truth("mdh"));
  run.solved(4.0, TestRun::truth("mdh"));
  run.solved(50.0, TestRun::truth("mdh", "texture source"));
  run.add(ShapeState::predicted, run.shifted(30.0), TestRun::truth("totem"));
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(MetricsReport, JsonHoldsWhatWasMeasured) {
  TestRun run;
  fill(run);
  const json metrics = json::parse(to_json(evaluated(run)));
  EXPECT_EQ(metrics["schema"], "weft-metrics/1");
  EXPECT_EQ(metrics["alignment"], "none");
  EXPECT_EQ(metrics["all"]["failures"], 1);
  EXPECT_DOUBLE_EQ(metrics["all"]["failure_percent"], 25.0);
  EXPECT_EQ(metrics["counts"]["frames"], 5);
  EXPECT_DOUBLE_EQ(metrics["counts"]["solved_percent"], 60.0);
  ASSERT_EQ(metrics["groups"].size(), 3U);
  EXPECT_EQ(metrics["groups"][0]["kind"], "mdh");
  EXPECT_EQ(metrics["groups"][0]["missing"], 1);
  EXPECT_NEAR(metrics["groups"][0]["error_solved"]["mean_mm"], 3.0, 1e-9);
  EXPECT_EQ(metrics["groups"][0]["error_solved"]["worst_frame"], "f2");
  EXPECT_EQ(metrics["groups"][2]["excluded"], "texture source");
  EXPECT_EQ(metrics["all"]["frames"], 4);
  ASSERT_EQ(metrics["frames"].size(), 5U);
  EXPECT_EQ(metrics["frames"][0]["truth"]["no_error_because"], "no shape");
  EXPECT_NEAR(metrics["frames"][1]["truth"]["p95_mm"], 2.0, 1e-9);
}

TEST(MetricsReport, WhatIsUnknownIsNull) {
  TestRun run;
  run.add(ShapeState::none, std::nullopt, TestRun::truth("mdh"));
  const json metrics = json::parse(to_json(evaluated(run)));
  EXPECT_TRUE(metrics["all"]["error_solved"]["mean_mm"].is_null());
  EXPECT_TRUE(metrics["all"]["error_solved"]["worst_frame"].is_null());
  EXPECT_TRUE(metrics["isometry_error_percent"].is_null());
}

TEST(MetricsReport, TheTableHasStraightColumnsAndNamesTheAlignment) {
  TestRun run;
  fill(run);
  run.solved(1.0, TestRun::truth("größe"));
  const std::string table = to_table(evaluated(run));
  EXPECT_THAT(table, HasSubstr("in mm, alignment: none"));
  EXPECT_THAT(to_table(evaluated(run, Alignment::rigid)), HasSubstr("alignment: rigid"));
  std::vector<std::size_t> widths;
  for (const std::string& line : lines_of(table)) {
    if (line.find(" mdh  ") == 1 || line.find("  all ") == 0 || line.find("  truth ") == 0) {
      widths.push_back(line.size());
    }
    // Two letters take two bytes each.
    if (line.find("  größe ") == 0) widths.push_back(line.size() - 2);
  }
  ASSERT_EQ(widths.size(), 4U) << table;
  for (const std::size_t width : widths) EXPECT_EQ(width, widths[0]) << table;
}

TEST(MetricsReport, RowsOfExcludedFramesAreBelowAllOthers) {
  TestRun run;
  fill(run);
  const std::string table = to_table(evaluated(run));
  const std::size_t all = table.find("\n  all "), excluded = table.find("mdh (texture source)");
  ASSERT_NE(all, std::string::npos);
  ASSERT_NE(excluded, std::string::npos);
  EXPECT_LT(all, excluded);
  EXPECT_THAT(table, HasSubstr("excluded, not in the rows above"));
}

TEST(MetricsReport, FailuresAndOldShapesAreSaid) {
  TestRun run;
  fill(run);
  const std::string table = to_table(evaluated(run));
  EXPECT_THAT(table, HasSubstr("mdh: 1 with truth but without a shape"));
  EXPECT_THAT(table, HasSubstr("totem: 1 carried over (predicted or lost): mean 30.00"));
}

TEST(MetricsReport, TheFramesTableHasARowForEachFrameAndTheWorstOnes) {
  TestRun run;
  fill(run);
  const std::string table = to_frames_table(evaluated(run, Alignment::none));
  EXPECT_THAT(table, HasSubstr("alignment: none"));
  const std::vector<std::string> lines = lines_of(table);
  ASSERT_EQ(lines.size(), 2U + 5U + 1U) << table;
  EXPECT_THAT(lines[2], HasSubstr("none"));
  EXPECT_THAT(lines[5], HasSubstr("mdh (texture source)"));
  EXPECT_EQ(lines.back(), "worst frames: f3 50.00, f4 30.00, f2 4.00, f1 2.00");
}

TEST(MetricsReport, AFurtherAlignmentIsATableOfErrorsAlone) {
  TestRun run;
  fill(run);
  const std::string table = to_error_table(evaluated(run, Alignment::scale));
  EXPECT_EQ(table.find("3D error of solved frames in mm, alignment: scale\n"), 0U);
  EXPECT_THAT(table, Not(HasSubstr("isometry error of solved frames")));
}

TEST(MetricsReport, WithoutTruthTheSharesAreStillGiven) {
  TestRun run;
  run.solved(1.0, std::nullopt);
  run.add(ShapeState::predicted, run.vertices(), std::nullopt);
  const std::string table = to_table(evaluated(run));
  EXPECT_THAT(table, HasSubstr("2 frames, 1 solved (50.0 %)"));
  EXPECT_THAT(table, HasSubstr("no ground truth in this run"));
  EXPECT_THAT(to_table(evaluated(TestRun())), HasSubstr("0 frames, 0 solved (- %)"));
}

TEST(MetricsReport, ResultsOfComponentsThatReadTheTruthAreMarked) {
  TestRun run;
  run.solved(1.0, TestRun::truth("mdh"));
  EXPECT_THAT(to_table(evaluated(run)), Not(HasSubstr("may read the ground truth")));
  run.write_text("manifest.json",
                 R"({"components": [{"id": "filters/oracle", "uses_truth": true}]})");
  EXPECT_THAT(to_table(evaluated(run)), HasSubstr("filters/oracle may read the ground truth"));
}

TEST(MetricsReport, TextOfFilesCannotControlTheTerminalOrBreakTheJson) {
  TestRun run;
  run.solved(1.0, TestRun::truth("a\x1b[2J\n\xff"));
  const RunMetrics metrics = evaluated(run);
  EXPECT_THAT(to_table(metrics), Not(HasSubstr("\x1b")));
  EXPECT_TRUE(json::accept(to_json(metrics)));
}

TEST(MetricsReport, TheFileIsWrittenWholeAndAgainTheSame) {
  TestRun run;
  fill(run);
  const RunMetrics metrics = evaluated(run);
  const std::string name = metrics_file_name(Alignment::none);
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(write_json(metrics, run.folder() + "/" + name));
    EXPECT_EQ(run.read_text(name), to_json(evaluated(run)));
    EXPECT_FALSE(std::filesystem::exists(run.folder() + "/" + name + ".part"));
  }
  EXPECT_EQ(name, "metrics.json");
  EXPECT_NE(metrics_file_name(Alignment::rigid), name);
}

TEST(MetricsReport, AFolderThatIsNotThereIsAnError) {
  const auto written = write_json(RunMetrics{}, "/nonexistent/metrics.json");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, Errc::io);
  EXPECT_EQ(written.error().where, "/nonexistent/metrics.json");
}

TEST(MetricsReport, ADeviceIsWrittenToAndNotReplaced) {
  ASSERT_TRUE(write_json(RunMetrics{}, "/dev/null"));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

}  // namespace
}  // namespace weft::lab
