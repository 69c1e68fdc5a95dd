// SPDX-License-Identifier: Apache-2.0
#include "lab/report/pairs/pair_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "fake_results.hpp"
#include "fake_run.hpp"
#include "lab/report/pairs/pair_content.hpp"
#include "lab/report/pairs/settings.hpp"

namespace weft::lab {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr const char* kPipeline =
    "weft: 1\nsource: {use: sources/images, params: {path: frames}}\n"
    "stages:\n  - {use: solvers/a, as: solvers, params: {damping: 1}}\n";

PairContent content_of(Result<PairContent> content) {
  if (!content) throw std::runtime_error(content.error().message + " " + content.error().where);
  return *std::move(content);
}

std::vector<std::string> column(const TextTable& table, std::size_t place) {
  std::vector<std::string> texts;
  for (const TextRow& row : table.rows) texts.push_back(row.cells[place].shown);
  return texts;
}

const TextTable& table_of(const PairContent& content, const std::string& id) {
  for (const TextTable& table : content.tables) {
    if (table.id == id) return table;
  }
  throw std::runtime_error("no table " + id);
}

TEST(PairSettings, AreMatchedByTheNamesOfStages) {
  const TextTable table = settings_sheet(
      "seed: 1\nstages:\n  - {use: filters/a}\n  - {use: solvers/b, as: s, params: {x: 1, y: 2}}\n",
      "seed: 1\nstages:\n  - {use: solvers/b, as: s, params: {x: 3, y: 2}}\n");
  EXPECT_THAT(column(table, 0), ElementsAre("stages.filters/a.use", "stages.s.params.x"));
  EXPECT_THAT(column(table, 1), ElementsAre("filters/a", "1"));
  EXPECT_THAT(column(table, 2), ElementsAre("–", "3"));
}

TEST(PairReport, ComparesTheErrorsOfTwoRunsFrameByFrame) {
  TestRun a, b;
  write_eight_frames(a);
  write_eight_frames(b, false, 1.0);
  std::string other = kPipeline;
  other.replace(other.find("damping: 1"), 10, "damping: 2");
  other.replace(other.find("{use: sources"), 5, "{isolate: process, use:");
  a.write_text("pipeline.yaml", kPipeline);
  b.write_text("pipeline.yaml", other);
  const PairContent content = content_of(compare_runs(a.folder(), b.folder()));
  EXPECT_THAT(content.refusals, IsEmpty());
  EXPECT_THAT(content.sentences,
              Contains("The mean 3D error of A is lower by 1 mm: 3 mm and 4 mm over 7 frames; 95 % "
                       "interval 1 to 1 mm."));
  EXPECT_THAT(content.sentences, Contains("A reconstructed 7 of 8 frames, B 7 of 8."));
  EXPECT_THAT(column(table_of(content, "settings"), 0),
              ElementsAre("source.isolate", "stages.solvers.params.damping"));
  EXPECT_THAT(column(table_of(content, "stage_times"), 3), ElementsAre("1.00", "1.00"));
  ASSERT_THAT(content.figures, SizeIs(3));
  EXPECT_EQ(content.figures[1].name(), "errors-by-frame");
}

TEST(PairReport, PairsNoFramesOfDifferentSources) {
  TestRun a, b;
  write_eight_frames(a);
  write_eight_frames(b);
  std::string other = kPipeline;
  other.replace(other.find("frames"), 6, "others");
  a.write_text("pipeline.yaml", kPipeline);
  b.write_text("pipeline.yaml", other);
  const PairContent content = content_of(compare_runs(a.folder(), b.folder()));
  EXPECT_THAT(content.refusals, ElementsAre(HasSubstr("the sources have different settings")));
  EXPECT_THAT(content.sentences, Not(Contains(HasSubstr("3D error"))));
  EXPECT_THAT(column(table_of(content, "settings"), 0), ElementsAre("source.params.path"));
}

TEST(PairReport, ComparesTheCombinationsOfTwoAblations) {
  FakeResults::Choice choice;
  choice.sequences = 16;
  choice.seeds = {1};
  const FakeResults a(choice);
  choice.more_mm = 0.5;
  const FakeResults b(choice);
  const PairContent content = content_of(compare_ablations(a.folder(), b.folder()));
  EXPECT_THAT(content.refusals, IsEmpty());
  const TextTable& pairs = table_of(content, "pairs");
  ASSERT_THAT(pairs.rows, SizeIs(12));
  EXPECT_EQ(pairs.rows[1].cells[0].shown, "steady · 0.1");
  EXPECT_EQ(pairs.rows[1].cells[3].shown, "-0.5");
  EXPECT_EQ(pairs.rows[1].cells[7].shown, "16");
  EXPECT_THAT(content.sentences, ElementsAre("A is better in 8 of 12 combinations, B in 0; the "
                                             "others are not decided."));
  EXPECT_THAT(pairs.rows[1].cells[0].tip, HasSubstr("A is better than B"));
  EXPECT_EQ(pairs.rows[11].cells[3].shown, "–") << "broken has no error";
}

TEST(PairReport, NamesWhyTwoAblationsCannotBeCompared) {
  FakeResults::Choice choice;
  choice.sequences = 2;
  const FakeResults a(choice);
  FakeResults b(choice);
  nlohmann::json plan = nlohmann::json::parse(b.read("plan.json"));
  for (auto& cell : plan["cells"]) {
    cell["sequence"] = "other" + cell["sequence"].get<std::string>();
  }
  plan["sequences"] = {"otherplain_101", "otherplain_102"};
  b.write("plan.json", plan);
  EXPECT_THAT(content_of(compare_ablations(a.folder(), b.folder())).refusals,
              ElementsAre(HasSubstr("no sequence is in both")));
  b.write("manifest.json",
          {{"schema", "weft.results/1"}, {"weft", "0.1.0"}, {"metrics", {{"alignment", "rigid"}}}});
  EXPECT_THAT(content_of(compare_ablations(a.folder(), b.folder())).refusals,
              ElementsAre(HasSubstr("alignments none and rigid")));
}

TEST(PairReport, WritesAPageWithTablesAndFiguresBesideIt) {
  TestRun a, b;
  write_eight_frames(a);
  write_eight_frames(b, false, 1.0);
  for (const TestRun* run : {&a, &b}) run->write_text("pipeline.yaml", kPipeline);
  std::filesystem::create_directories(a.folder() + "/assets");
  a.write_text("assets/report.css", "body {}");
  const std::string page = a.folder() + "/both.html";
  const auto files = write_pair_report(a.folder(), b.folder(), {page, a.folder() + "/assets"});
  ASSERT_TRUE(files) << files.error().message;
  EXPECT_THAT(a.read_text("both.html"), HasSubstr("The mean 3D error of A is lower by 1 mm"));
  EXPECT_THAT(a.read_text("both.html"), HasSubstr("figure-errors-by-frame"));
  EXPECT_THAT(a.read_text("both/tables.md"), HasSubstr("- The mean 3D error of A is lower"));
  EXPECT_THAT(a.read_text("both/paired-errors.pgf"), HasSubstr("\\begin{pgfpicture}"));
  EXPECT_THAT(a.read_text("both/errors-by-frame.svg"), HasSubstr("<svg"));
}

TEST(PairReport, RefusesFoldersThatAreNoPair) {
  TestRun run;
  write_eight_frames(run);
  const FakeResults results({});
  const auto same = write_pair_report(run.folder(), run.folder() + "/.", {});
  ASSERT_FALSE(same);
  EXPECT_THAT(same.error().message, HasSubstr("the first folder again"));
  const auto mixed = write_pair_report(run.folder(), results.folder(), {});
  ASSERT_FALSE(mixed);
  EXPECT_THAT(mixed.error().message, HasSubstr("is an ablation, the first folder a run"));
}

}  // namespace
}  // namespace weft::lab
