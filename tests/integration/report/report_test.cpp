// SPDX-License-Identifier: Apache-2.0
#include "lab/report/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "fake_results.hpp"
#include "lab/report/paper/paper.hpp"
#include "lab/report/tables/tables.hpp"
#include "lab/report/text/latex.hpp"
#include "lab/report/text/text_table.hpp"

namespace weft::lab {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Results read(const FakeResults& fake) {
  auto results = read_results(fake.folder());
  if (!results) throw std::runtime_error(results.error().where + ": " + results.error().message);
  return *std::move(results);
}

ReportTables tables_of(const Results& results) {
  auto tables = make_tables(results);
  if (!tables) throw std::runtime_error(tables.error().message);
  return *std::move(tables);
}

std::string written(FakeResults& fake) {
  const std::string assets = fake.folder() + "/assets";
  std::filesystem::create_directories(assets);
  fake.append("assets/report.css", "body {}");
  const auto files = write_report(fake.folder(), {"", assets});
  if (!files) throw std::runtime_error(files.error().where + ": " + files.error().message);
  EXPECT_FALSE(files->figures);
  return fake.read("report.html");
}

const Combination& named(const ReportTables& tables, const std::string& name) {
  for (const Combination& row : tables.combinations) {
    if (row.name == name) return row;
  }
  throw std::runtime_error("no combination " + name);
}

TEST(Report, HasARowForEveryCombinationWhateverBecameOfIt) {
  const FakeResults fake({});
  const ReportTables tables = tables_of(read(fake));
  ASSERT_EQ(tables.combinations.size(), 12U);
  const Combination& broken = named(tables, "broken · 0.1");
  EXPECT_EQ(broken.failed, 16);
  EXPECT_EQ(broken.done, 0);
  EXPECT_TRUE(std::isnan(broken.mean_mm));
  EXPECT_EQ(broken.sequences, 0);
  EXPECT_EQ(broken.failures, 160) << "a cell that failed as a whole failed at every frame";
  EXPECT_EQ(broken.truth_frames, 160);
}

TEST(Report, TakesMeansOverSequencesAndCountsFramesWithoutAShape) {
  const FakeResults fake({});
  const ReportTables tables = tables_of(read(fake));
  // Sequences add 0, 0.1 ... 0.7 mm and frames 0, 0.01 ... 0.09 mm.
  const Combination& steady = named(tables, "steady · 0.1");
  EXPECT_NEAR(steady.mean_mm, 2.0 + 0.35 + 0.045, 1e-9);
  EXPECT_EQ(steady.sequences, 8);
  EXPECT_EQ(steady.failures, 0);
  EXPECT_NEAR(steady.worst_mm, 2.79, 1e-9);
  EXPECT_EQ(steady.worst_place, "plain_108, seed 1, frame 9");
  // Four sequences err by 1 mm more; in the first the last frame is missing for both seeds.
  const Combination& shaky = named(tables, "shaky · 0.1");
  EXPECT_NEAR(shaky.mean_mm, 2.0 + 0.35 + 0.5 + (7 * 0.045 + 0.04) / 8, 1e-9);
  EXPECT_EQ(shaky.failures, 2);
  EXPECT_EQ(shaky.solved, 158);
  EXPECT_EQ(shaky.frames, 160);
}

TEST(Report, CountsASequenceOnceHoweverManyOfItsSeedsAreThere) {
  const FakeResults fake({});
  Results results = read(fake);
  const Combination before = named(tables_of(results), "steady · 0.1");
  // One seed of the last sequence fails, so that the other stands for the sequence.
  CellRecord& last = results.records.cells[results.plan.cells[before.cells.back()].key];
  last = CellRecord();
  last.outcome = CellOutcome::failed;
  const Combination after = named(tables_of(results), "steady · 0.1");
  EXPECT_EQ(after.failed, 1);
  EXPECT_EQ(after.sequences, 8);
  EXPECT_NEAR(after.mean_mm, before.mean_mm, 1e-12);
}

TEST(Report, LeavesNoCellOutThatHasNotBeenRun) {
  const FakeResults fake({});
  Results results = read(fake);
  const Combination row = combinations_of(results).front();
  results.records.cells.erase(results.plan.cells[row.cells.front()].key);
  EXPECT_EQ(tables_of(results).combinations.front().missing, 1);
}

TEST(Report, SharesALineBetweenCellsOfOneKey) {
  const FakeResults fake({});
  Results results = read(fake);
  results.plan.cells[1].key = results.plan.cells[0].key;
  results.plan.cells[1].seed = 2;
  EXPECT_EQ(tables_of(results).combinations.front().done, 16);
}

TEST(Report, IgnoresALastLineThatWasCutOff) {
  const FakeResults fake({});
  fake.append("results/0.jsonl", R"({"schema": "weft.cell/1", "key": "00)");
  EXPECT_TRUE(read_results(fake.folder()));
}

TEST(Report, LetsTheFirstLineOfAKeyCount) {
  const FakeResults fake({});
  fake.append("results/zz.jsonl",
              R"({"schema": "weft.cell/1", "key": "00000000000000000000000000000001",)"
              R"( "outcome": "failed", "reason": "later", "metrics": null})"
              "\n");
  EXPECT_EQ(named(tables_of(read(fake)), "steady · 0.05").failed, 0);
}

struct DamagedFile {
  std::string file, text;
  Errc code;
  std::string where, message;
};

TEST(Report, NamesThePlaceOfDamage) {
  const std::vector<DamagedFile> damages = {
      {"manifest.json", R"({"schema": "weft.results/9"})", Errc::incompatible, "manifest.json",
       "weft.results/9"},
      {"manifest.json", R"({"schema": "weft.results/1", "metrics": {"alignment": 1}})",
       Errc::invalid_data, "manifest.json", "string"},
      {"manifest.json", "[1, 2]", Errc::invalid_data, "manifest.json", "object"},
      {"plan.json", R"({"name": "x"})", Errc::invalid_data, "plan.json", "axes"},
      {"results/a.jsonl", "{\"schema\": \"weft.cell/9\"}\n", Errc::incompatible,
       "results/a.jsonl:1", "weft.cell/9"},
  };
  for (const DamagedFile& damage : damages) {
    FakeResults::Choice few;
    few.sequences = 1;
    const FakeResults fake(few);
    std::ofstream(fake.folder() + "/" + damage.file, std::ios::trunc) << damage.text;
    const auto results = read_results(fake.folder());
    ASSERT_FALSE(results) << damage.text;
    EXPECT_EQ(results.error().code, damage.code) << damage.text;
    EXPECT_THAT(results.error().where, HasSubstr(damage.where));
    EXPECT_THAT(results.error().message, HasSubstr(damage.message));
  }
}

TEST(Report, LeavesDamagedLinesOutAndNamesThem) {
  for (const auto& [line, what] : {
           std::pair<std::string, std::string>{R"({"schema": )", "not a JSON object"},
           {R"({"schema":"weft.cell/2","key":"00000000000000000000000000000001"})", "check"},
           {R"({"schema": "weft.cell/1", "key": "../../x"})", "32 hexadecimal digits"},
           {R"({"schema": "weft.cell/1", "key": "00000000000000000000000000000001"})", "outcome"},
       }) {
    FakeResults fake({});
    fake.append("results/a.jsonl", line + "\n");
    const Results results = read(fake);
    ASSERT_EQ(results.records.damaged.size(), 1U) << line;
    EXPECT_THAT(results.records.damaged[0].where, ::testing::EndsWith("results/a.jsonl:1"));
    EXPECT_THAT(results.records.damaged[0].what, HasSubstr(what));
    written(fake);
    EXPECT_THAT(fake.read("report/tables.md"), HasSubstr("results/a.jsonl:1"));
    EXPECT_THAT(fake.read("report/tables.md"), HasSubstr("--retry damaged"));
  }
}

TEST(Report, PrintsCommandsAsAShellTakesThem) {
  FakeResults fake({});
  nlohmann::json plan = nlohmann::json::parse(fake.read("plan.json"));
  plan["command"] = "weft ablate 'it'\\''s `mine`.yaml'";
  fake.write("plan.json", plan);
  written(fake);
  EXPECT_THAT(fake.read("report/tables.md"),
              HasSubstr("with `` weft ablate 'it'\\''s `mine`.yaml' ``."));
}

TEST(Report, RefusesAFolderThatHoldsNoResults) {
  const auto results = read_results(::testing::TempDir());
  ASSERT_FALSE(results);
  EXPECT_EQ(results.error().code, Errc::not_found);
  EXPECT_THAT(results.error().message, HasSubstr("weft ablate"));
}

TEST(Report, ReadsFiguresThatThePlanNames) {
  FakeResults fake({});
  nlohmann::json plan = nlohmann::json::parse(fake.read("plan.json"));
  plan["show"] = {"filters.tpr_percent", "filters.filters.fpr_percent",
                  "filters.other.tpr_percent"};
  plan["expect"] = {
      {{"where", {{"filter", "steady"}, {"alpha", 0.1}, {"seed", 1}}},
       {"metric", "filters.tpr_percent"},
       {"at_least", 89.0}},
      {{"where", {{"alpha", 0.1}}}, {"metric", "filters.tpr_percent"}, {"at_least", 1}},
      {{"where", {{"filter", "steady"}, {"sequence", "plain_101"}}},
       {"metric", "all.error_solved.mean_mm"},
       {"at_most", 2.0}}};
  fake.write("plan.json", plan);
  const ReportTables tables = tables_of(read(fake));
  const Combination& row = named(tables, "steady · 0.1");
  ASSERT_EQ(row.shown.size(), 3U);
  EXPECT_NEAR(row.shown[0], FakeResults::tpr(1), 1e-9);
  EXPECT_NEAR(row.shown[1], FakeResults::fpr(1), 1e-9);
  EXPECT_TRUE(std::isnan(row.shown[2]));
  ASSERT_EQ(tables.expectations.size(), 3U);
  EXPECT_TRUE(tables.expectations[0].met);
  EXPECT_EQ(tables.expectations[0].cells, 8);
  EXPECT_FALSE(tables.expectations[1].met) << "the broken filter has no such figure";
  EXPECT_EQ(tables.expectations[1].without, 16);
  EXPECT_FALSE(tables.expectations[2].met);
  EXPECT_NEAR(tables.expectations[2].mean, 2.045, 1e-9);
}

TEST(Report, ShowsTimesOnlyOfAPassThatTookThem) {
  FakeResults cached({});
  EXPECT_FALSE(tables_of(read(cached)).has_times);
  EXPECT_THAT(written(cached), HasSubstr("--timing"));
  FakeResults::Choice alone;
  alone.timing = alone.old_times = true;
  FakeResults timed(alone);
  const ReportTables tables = tables_of(read(timed));
  ASSERT_EQ(named(tables, "steady · 0.1").times.size(), 3U);
  const std::vector<StageTime>& times = named(tables, "steady · 0.1").times;
  EXPECT_NEAR(times[2].mean_ms, 1.5, 1e-12);
  EXPECT_NEAR(times[2].mean_processor_ms, 2.75, 1e-12);
  EXPECT_TRUE(std::isnan(times[1].mean_processor_ms));
  EXPECT_TRUE(std::isnan(named(tables, "steady · 0.1").processor_ms));
  EXPECT_THAT(written(timed), Not(HasSubstr("Time against accuracy")));
  EXPECT_THAT(written(timed), HasSubstr("detectors"));
  EXPECT_THAT(timed.read("report/times.csv"), HasSubstr("filters,1.5,1.25,2.75\n"));
}

TEST(Report, TellsHowManyFramesFitIntoASecondWhereAStageRunsInSomeFramesAlone) {
  FakeResults::Choice alone;
  alone.timing = true;
  FakeResults timed(alone);
  // Three calls of 6 ms and two of 2.75 ms in three frames.
  EXPECT_NEAR(named(tables_of(read(timed)), "steady · 0.1").processor_ms, 6.0 + 5.5 / 3.0, 1e-12);
  EXPECT_THAT(written(timed), HasSubstr("Time against accuracy"));
  EXPECT_THAT(timed.read("report/speed.csv"), HasSubstr(",7.83333333,127.659574\n"));
}

TEST(Report, WritesTablesAsCsvAndMarkdown) {
  FakeResults fake({});
  written(fake);
  const std::string csv = fake.read("report/combinations.csv");
  EXPECT_THAT(csv, HasSubstr("filter,alpha,mean_mm,low_mm,high_mm,worst_mm"));
  EXPECT_THAT(csv, HasSubstr("\nsteady,0.1,2.395,"));
  EXPECT_THAT(csv, HasSubstr(",filters/fake: reconstruction,no\n"));
  EXPECT_THAT(csv, HasSubstr("\nbroken,0.2,,,,,0,160,160,160,0,,16,16,0,0,,no\n"));
  const std::string cells = fake.read("report/cells.csv");
  EXPECT_EQ(std::count(cells.begin(), cells.end(), '\n'), 1 + 192);
  EXPECT_THAT(cells, HasSubstr(FakeResults::kReason));
  EXPECT_THAT(cells, HasSubstr("128,broken,0.05,plain_101,1,failed,,,0,10,10,10,"));
  const std::string filters = fake.read("report/filters.csv");
  EXPECT_THAT(filters, HasSubstr("\nsteady,0.2,filters,69,5,60,95,16000,6400,8\n"));
  EXPECT_THAT(fake.read("report/tables.md"), HasSubstr("| steady | 0.1 | 2."));
}

TEST(Report, SaysOfEachCombinationHowSureItWasAndWhetherItWasRight) {
  FakeResults fake({});
  EXPECT_THAT(written(fake), HasSubstr("Silently wrong"));
  const std::string csv = fake.read("report/confidence.csv");
  EXPECT_THAT(
      csv,
      HasSubstr(
          "filter,alpha,frames,mean_confidence,brier,right,silently_wrong,within_1_std_percent,"
          "within_2_std_percent,within_3_std_percent\n"));
  EXPECT_THAT(csv, HasSubstr("\nsteady,0.1,160,0.9,0.0125,160,0,66.6666667,95.2380952,100\n"));
  // Two seeds of eight sequences, 40 frames of them wrong, two missing.
  EXPECT_THAT(csv, HasSubstr("\nshaky,0.1,158,0."));
  EXPECT_THAT(csv, HasSubstr(",118,8,66.6666667,95.2380952,100\n"));
  EXPECT_THAT(csv, Not(HasSubstr("broken"))) << "it says nothing";
  const CertaintyCounts counts = named(tables_of(read(fake)), "shaky · 0.1").certainty;
  EXPECT_EQ(counts.bins[6].frames, 80);
  EXPECT_NEAR(counts.bins[6].came_true, 1.0, 1e-12);
  EXPECT_EQ(counts.bins[5].frames, 78);
  EXPECT_NEAR(counts.bins[5].said, 0.55, 1e-12);
  EXPECT_NEAR(counts.bins[5].came_true, 38.0 / 78.0, 1e-12);
}

TEST(Report, SaysWhereItHasTablesOnlyAndShowsTextAsText) {
  FakeResults fake({});
  const std::string page = written(fake);
  EXPECT_THAT(page, HasSubstr("This report has tables only"));
  EXPECT_THAT(page, HasSubstr("<title>Filters &lt;on&gt; a plain sheet</title>"));
  EXPECT_THAT(page, HasSubstr("signal 11 &lt;/script&gt;&lt;b&gt;"));
  EXPECT_THAT(page, Not(HasSubstr("</script>")));
  EXPECT_THAT(page, Not(HasSubstr("http")));
}

TEST(Report, WarnsOfFiguresThatAreForTuning) {
  FakeResults::Choice tuning;
  tuning.data_use = "tuning";
  FakeResults fake(tuning);
  EXPECT_THAT(written(fake), HasSubstr("not for publication"));
}

TEST(Report, SaysInShortWhatFailedAndWhatIsUndecided) {
  FakeResults::Choice two;
  two.sequences = 2;
  FakeResults fake(two);
  nlohmann::json plan = nlohmann::json::parse(fake.read("plan.json"));
  plan["expect"] = {
      {{"where", {{"filter", "steady"}}}, {"metric", "filters.tpr_percent"}, {"at_least", 1}},
      {{"where", {{"filter", "broken"}}}, {"metric", "filters.tpr_percent"}, {"at_least", 1}}};
  fake.write("plan.json", plan);
  for (const std::string& text : {written(fake), fake.read("report/tables.md")}) {
    EXPECT_THAT(text, HasSubstr("16 of 48 cells failed"));
    EXPECT_THAT(text, HasSubstr("Too few sequences to decide: 2 of at least 6."));
    EXPECT_THAT(text, HasSubstr("Expectations: 1 of 2 met."));
    EXPECT_THAT(text, HasSubstr("weft ablate stages.yaml --out results/stages"));
  }
  EXPECT_THAT(fake.read("report/comparisons.csv"), HasSubstr(",too few to decide,"));
  EXPECT_THAT(fake.read("report/expectations.csv"), HasSubstr(",1,,,16,16,no\n"));
}

TEST(Report, CountsFramesInErrorAndTellsTheFirst) {
  FakeResults::Choice choice;
  choice.errors = true;
  FakeResults fake(choice);
  const std::string page = written(fake);
  // Four values of alpha, eight sequences and two seeds, two frames each.
  EXPECT_THAT(page, HasSubstr("128 frames had an error; the first: "
                              "shaky · 0.05, plain_101, seed 1, frame 3, filters: refused."));
  EXPECT_THAT(fake.read("report/combinations.csv"),
              HasSubstr(",32,\"plain_101, seed 1, frame 3, filters: refused\","));
  EXPECT_THAT(fake.read("report/cells.csv"), HasSubstr(",2,\"frame 3, filters: refused\","));
}

TEST(Report, GivesTheCommandOfACellTheFoldersOfPluginsOfTheAblation) {
  FakeResults fake({});
  nlohmann::json plan = nlohmann::json::parse(fake.read("plan.json"));
  plan["command"] = "weft --plugin-path build ablate stages.yaml";
  fake.write("plan.json", plan);
  EXPECT_THAT(written(fake), HasSubstr("weft --plugin-path build run "));
}

/// The plan of `fake` with another axis `light`: its values are its odd and even seeds.
void split_by_light(const FakeResults& fake) {
  nlohmann::json plan = nlohmann::json::parse(fake.read("plan.json"));
  plan["axes"].push_back({{"name", "light"}, {"values", {"day", "night"}}});
  for (nlohmann::json& cell : plan["cells"]) {
    cell["axes"]["light"] = cell["seed"] == 1 ? "day" : "night";
    cell["seed"] = 1;
  }
  fake.write("plan.json", plan);
}

TEST(Report, SplitsAVerdictByTheOtherAxes) {
  FakeResults::Choice ten;
  ten.sequences = 10;
  FakeResults fake(ten);
  split_by_light(fake);
  const ReportTables tables = tables_of(read(fake));
  ASSERT_EQ(tables.comparisons.size(), 1U);
  const ComparisonResult& comparison = tables.comparisons.front();
  ASSERT_EQ(comparison.separate.size(), 1U) << "alpha is swept: it has a figure instead";
  EXPECT_EQ(comparison.separate[0].axis, "light");
  EXPECT_EQ(comparison.separate[0].values, (std::vector<std::string>{"day", "night"}));
  for (const ComparisonTable& table : comparison.separate[0].tables) {
    ASSERT_EQ(table.pairs.size(), 2U);
    // Every other sequence errs by 1 mm more; one frame of the first is missing.
    EXPECT_NEAR(table.pairs[0].test.mean, 0.5, 1e-9);
    EXPECT_EQ(table.pairs[0].test.n, 10);
  }
  written(fake);
  const std::string text = fake.read("report/tables.md");
  EXPECT_THAT(text, HasSubstr("- **filter** Better than steady in mean 3D error: nothing. Worse:"));
  EXPECT_THAT(text, HasSubstr("  - With light day, better than steady in mean 3D error: "));
  EXPECT_THAT(text, HasSubstr("  - With light night, better than steady"));
}

TEST(Report, FoldsColumnsInWhichAllRowsHaveTheSame) {
  TextTable table{"t",
                  "T",
                  "What it means.",
                  {{"name", "name", false, "", true},
                   {"mean", "mean", true},
                   {"failed", "failed", true, "of", true},
                   {"n", "n", true, "", true}},
                  {}};
  for (const char* name : {"a", "b"}) {
    TextRow row{{text_cell(name), number_cell(1.0, 1), text_cell("0 of 20"), count_cell(8)}};
    row.cells[2].exact = "0";
    row.cells[2].of = "20";
    table.rows.push_back(row);
  }
  EXPECT_EQ(to_markdown(table),
            "## T\n\n"
            "In every row: failed 0 of 20; n 8. What it means.\n\n| name | mean |\n|---|---:|\n"
            "| a | 1.0 |\n| b | 1.0 |\n\n")
      << "a measured figure stays, however alike it is";
  EXPECT_EQ(to_csv(table), "name,mean,failed,of,n\na,1,0,20,8\nb,1,0,20,8\n");
  table.rows[1].cells[3] = count_cell(9);
  EXPECT_THAT(to_html(table), HasSubstr("<td class=\"number\" data-value=\"9\">9</td>"));
  table.rows.pop_back();
  EXPECT_EQ(folded(table).columns.size(), 4U);
}

TEST(Report, WritesTablesAndAFigureForAPaperWithTheirOrigin) {
  FakeResults fake({});
  const auto files = write_paper(fake.folder());
  ASSERT_TRUE(files) << files.error().message;
  const std::string table = fake.read("paper/combinations.tex");
  EXPECT_THAT(table,
              HasSubstr("% Filters <on> a plain sheet: Weft 0.1.0, weft ablate stages.yaml "
                        "--out results/stages\n% sequences (name and data seed): plain_101, "));
  EXPECT_THAT(table,
              HasSubstr("\\begin{tabular}{llrrrrrrrrl}\n\\toprule\nfilter & alpha & mean, mm & "
                        "95 \\% from & to & worst, mm"));
  EXPECT_THAT(table, HasSubstr("\nsteady & 0.1 & 2.395 & "));
  const std::string figure = fake.read("paper/ranking-combinations.svg");
  EXPECT_THAT(figure, HasSubstr("<desc>Filters &lt;on&gt; a plain sheet: Weft 0.1.0"));
  std::size_t points = 0;
  for (std::size_t at = 0; (at = figure.find("<circle", at)) != std::string::npos; ++at) ++points;
  EXPECT_EQ(points, 8U) << "the four combinations of `broken` have no error";
  const std::string pgf = fake.read("paper/differences-filter-steady.pgf");
  EXPECT_THAT(pgf, HasSubstr("% Filters <on> a plain sheet: Weft 0.1.0"));
  EXPECT_THAT(pgf, HasSubstr("shaky $-$ steady"));
  EXPECT_FALSE(std::filesystem::exists(fake.folder() + "/paper/cells.tex"));
}

/// The search path of programs, with one `rsvg-convert` that runs a script, or none.
class Programs {
 public:
  Programs(const std::string& folder, const std::string& script) {
    std::filesystem::create_directories(folder);
    const std::string file = folder + "/rsvg-convert";
    if (!script.empty()) {
      std::ofstream(file) << "#!/bin/sh\n" << script << "\n";
      std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    }
    setenv("PATH", folder.c_str(), 1);
  }
  ~Programs() { setenv("PATH", before_.c_str(), 1); }
  Programs(const Programs&) = delete;
  Programs& operator=(const Programs&) = delete;

 private:
  std::string before_ = getenv("PATH") == nullptr ? "" : getenv("PATH");
};

TEST(Report, WritesFiguresAsPdfWhereAProgramForItIsInstalled) {
  FakeResults fake({});
  {
    const Programs none(fake.folder() + "/none", "");
    const auto paper = write_paper(fake.folder());
    ASSERT_TRUE(paper) << paper.error().message;
    EXPECT_TRUE(paper->figures);
    EXPECT_FALSE(paper->pdf);
    EXPECT_THAT(paper->files.back(), HasSubstr("paper/rates-filters.svg"));
  }
  {
    const Programs one(fake.folder() + "/one",
                       "echo \"$1 $SOURCE_DATE_EPOCH $3\" > \"${2#--output=}\"");
    const auto paper = write_paper(fake.folder());
    ASSERT_TRUE(paper) << paper.error().message;
    EXPECT_TRUE(paper->pdf);
    EXPECT_THAT(paper->files.back(), HasSubstr("paper/rates-filters.pdf"));
    EXPECT_EQ(fake.read("paper/rates-filters.pdf"),
              "--format=pdf 0 " + fake.folder() + "/paper/rates-filters.svg\n");
  }
  const Programs fails(fake.folder() + "/fails", "exit 1");
  const auto paper = write_paper(fake.folder());
  ASSERT_FALSE(paper);
  EXPECT_THAT(paper.error().message, HasSubstr("rsvg-convert did not make a PDF"));
  EXPECT_THAT(paper.error().where, HasSubstr("ranking-combinations.svg"));
}

TEST(Report, LeavesNoMarkupInTextForLatex) {
  EXPECT_EQ(latex_escaped("a_b & 5 % of {x} − 1 · \\"),
            "a\\_b \\& 5 \\% of \\{x\\} $-$ 1 $\\cdot$ \\textbackslash{}");
}

TEST(Report, NamesMetricsAsPeopleDoAndInFilesAsProgramsDo) {
  FakeResults fake({});
  nlohmann::json plan = nlohmann::json::parse(fake.read("plan.json"));
  plan["show"] = {"filters.tpr_percent"};
  fake.write("plan.json", plan);
  EXPECT_THAT(written(fake), HasSubstr("mismatches rejected (TPR), %"));
  EXPECT_THAT(fake.read("report/combinations.csv"), HasSubstr(",filters.tpr_percent,"));
}

TEST(Report, SaysHowErrorsWereMeasuredAndMeasuresThemSoAgain) {
  FakeResults fake({});
  fake.write("manifest.json", {{"schema", "weft.results/1"},
                               {"metrics", {{"alignment", "rigid"}, {"match_tolerance_px", 3.5}}}});
  const std::string page = written(fake);
  EXPECT_THAT(page, HasSubstr("after one rigid motion a frame was taken out"));
  EXPECT_THAT(page, HasSubstr("up to 3.5 px"));
  EXPECT_THAT(page,
              HasSubstr("/pipeline.yaml --out runs/00000000000000000000000000000001 &amp;&amp; "
                        "weft eval runs/00000000000000000000000000000001 --alignment rigid "
                        "--match-tolerance-px 3.5"));
}

TEST(Report, KeepsThePageOfALargePlanSmall) {
  FakeResults::Choice many;
  many.sequences = 4;
  many.seeds = {1};
  many.alphas = 200;
  FakeResults fake(many);
  const std::string page = written(fake);
  EXPECT_LT(page.size(), 2'000'000U) << "2400 cells of 600 combinations";
  EXPECT_THAT(page, HasSubstr("<code>report/cells.csv</code> has all"));
  const auto count = [&](const std::string& text) {
    std::size_t found = 0;
    for (std::size_t at = 0; (at = page.find(text, at)) != page.npos; ++at) ++found;
    return found;
  };
  EXPECT_EQ(count("data-treatment="), 64U);
  EXPECT_EQ(count("id=\"reproduce-"), 64U + 100U) << "the best, and some of those with failures";
  const std::string cells = fake.read("report/cells.csv");
  EXPECT_EQ(std::count(cells.begin(), cells.end(), '\n'), 1 + 2400);
}

TEST(Report, SaysWhichOfItsOwnFilesIsMissing) {
  const FakeResults fake({});
  const auto files = write_report(fake.folder(), {"", fake.folder() + "/nowhere"});
  ASSERT_FALSE(files);
  EXPECT_THAT(files.error().where, HasSubstr("nowhere/report.css"));
}

}  // namespace
}  // namespace weft::lab
