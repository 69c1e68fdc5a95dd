// SPDX-License-Identifier: Apache-2.0
#include "lab/bench/report.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace weft::bench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

PipelineReport pipeline_of(const std::string& name, const std::vector<std::string>& stages,
                           double ms) {
  PipelineReport report;
  report.entry = {name, name + ".yaml", {}};
  for (const std::string& stage : stages) {
    Part part{stage, {}, {}};
    for (std::int64_t turn = 0; turn < 8; ++turn)
      part.samples.push_back({turn, 0, turn, {ms, ms, {}}});
    Row row{stage, "", {}, {}, {}, {}, {}, {}};
    row.ms = row.processor_ms = spread_of(std::vector<double>(8, ms));
    report.rows.push_back(row);
    report.parts.push_back(part);
  }
  report.counts = Counts{true, {}, 1000.0, 3048.0};
  return report;
}

std::vector<std::string> names_of(const std::vector<RatioReport>& ratios) {
  std::vector<std::string> names;
  for (const RatioReport& ratio : ratios)
    names.push_back(ratio.of + "/" + ratio.over + " " + ratio.part);
  return names;
}

TEST(Report, NamesPipelinesByTheirFiles) {
  std::vector<Entry> entries{
      {"", "a/demo.yaml", {}}, {"", "b/demo.yaml", {}}, {"", "other.yaml", {}}};
  name_entries(entries);
  EXPECT_EQ(entries[0].name, "demo");
  EXPECT_EQ(entries[1].name, "demo#2");
  EXPECT_EQ(entries[2].name, "other");
}

TEST(Report, ComparesWhatBothPipelinesHave) {
  const auto ratios = ratios_of({pipeline_of("a", {"filters", "warps", kFrame}, 3.0),
                                 pipeline_of("b", {"warps", kFrame}, 2.0)},
                                "b");
  EXPECT_THAT(names_of(ratios), ElementsAre("a/b frame", "a/b warps"));
  EXPECT_NEAR(ratios.front().wall.ratio, 1.5, 1e-12);
}

TEST(Report, ComparesTheFirstWithAllAndAllWithTheBaseline) {
  const auto ratios = ratios_of({pipeline_of("a", {kFrame}, 3.0), pipeline_of("b", {kFrame}, 2.0),
                                 pipeline_of("c", {kFrame}, 1.0)},
                                "c");
  EXPECT_THAT(names_of(ratios), ElementsAre("a/b frame", "a/c frame", "b/c frame"));
}

TEST(Report, TellsProcessorTimeAsAMultipleOfTheFloor) {
  Row row{"filters", "", {}, {}, {}, {}, {}, {}};
  row.ms = spread_of(std::vector<double>{40.0});
  row.processor_ms = spread_of(std::vector<double>{6.0});
  EXPECT_TRUE(std::isnan(times_floor(row)));
  row.floor_ms = 0.5;
  EXPECT_DOUBLE_EQ(times_floor(row), 12.0);
}

TEST(Report, HasNullWhereNothingIsKnown) {
  Report report;
  report.pipelines = {pipeline_of("a", {kFrame}, 3.0)};
  report.pipelines.front().counts.reset();
  report.pipelines.front().why_no_counts = "it was not there";
  const auto json = nlohmann::json::parse(json_of(report));
  EXPECT_EQ(json["schema"], "weft-bench/1");
  EXPECT_TRUE(json["baseline"].is_null());
  EXPECT_TRUE(json["pipelines"][0]["memory"].is_null());
  EXPECT_TRUE(json["pipelines"][0]["parts"][0]["floor_ms"].is_null());
  EXPECT_EQ(json["pipelines"][0]["frames"].size(), 8U);
  EXPECT_THAT(table_of(report), HasSubstr("allocations were not counted: it was not there"));
}

TEST(Report, TellsMemoryAboveThatOfTheLibraries) {
  Report report;
  report.pipelines = {pipeline_of("a", {kFrame}, 3.0)};
  const auto json = nlohmann::json::parse(json_of(report));
  EXPECT_EQ(json["pipelines"][0]["memory"]["above_loaded_kib"], 2048.0);
  EXPECT_THAT(table_of(report), HasSubstr("2.0 above"));
}

TEST(Counts, AreTheSameWhenTheyAreReadAgain) {
  const Counts counts{true, {{"filters", {3, 4}, {100, 200}}}, 10.5, 20.25};
  const auto read = counts_in(text_of(counts));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(read->allocations);
  ASSERT_EQ(read->parts.size(), 1U);
  EXPECT_EQ(read->parts[0].name, "filters");
  EXPECT_THAT(read->parts[0].blocks, ElementsAre(3, 4));
  EXPECT_THAT(read->parts[0].bytes, ElementsAre(100, 200));
  EXPECT_EQ(read->loaded_kib, 10.5);
  EXPECT_EQ(read->peak_kib, 20.25);
}

TEST(Counts, ThatCannotBeReadAreAnError) {
  EXPECT_FALSE(counts_in(""));
  EXPECT_FALSE(counts_in("{}"));
  EXPECT_FALSE(counts_in(R"({"schema": "weft-bench-counts/2"})"));
}

TEST(MachineSpeed, FollowsTheClock) {
  double now_ms = 0.0;
  // Every look at the clock finds it 10 ms later: all work takes 10 ms.
  const MachineSpeed speed = measure_machine([&] { return now_ms += 10.0; });
  EXPECT_NEAR(speed.memory_bytes_per_s, 100.0 * 2.0 * 128.0 * 1024.0 * 1024.0, 1.0);
  EXPECT_NEAR(speed.multiply_adds_per_s, 100.0 * 16.0 * 10000.0, 1.0);
  EXPECT_NEAR(floor_ms(speed.memory_bytes_per_s, speed), 1000.0, 1e-9);
}

}  // namespace
}  // namespace weft::bench
