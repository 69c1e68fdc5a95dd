// SPDX-License-Identifier: Apache-2.0
// Conditions for a cell to become a result, and for a stored result to be trusted.

#include <functional>

#include "ablation_fixture.hpp"
#include "lab/report/tables/tables.hpp"
#include "support/child.hpp"

namespace weft::lab {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class Trust : public AblationTest {
 protected:
  std::string file() const { return path("out/results/cached-000001.jsonl"); }

  void change_line(std::size_t number, const std::function<void(std::string&)>& change) const {
    std::vector<std::string> all = weft::testing::read_lines(file());
    change(all.at(number));
    std::ofstream stream(file(), std::ios::trunc);
    for (const std::string& line : all) stream << line << "\n";
  }

  weft::testing::Ended weft(std::vector<std::string> words) const {
    words.insert(words.begin(), {WEFT_PROGRAM, "--plugin-path", WEFT_TEST_PLUGINS});
    return weft::testing::Child(words, path("printed")).wait();
  }
};

constexpr const char* kTwo =
    "axes: {every: {set: filters.every, values: [2, 3]}}\ndata: {all: {}}\n";

TEST_F(Trust, ACellFailsWhereARunOfItsPipelineWould) {
  Grid grid = expand(
      "axes:\n  rule:\n    values:\n      none: {}\n"
      "      two: {set: {max_failed: 2}}\n      stop: {set: {max_failed: 2, on_error: stop}}\n"
      "data: {all: {set: {source.frames: 4, solvers.error_at: [1, 2]}}}\n"
      "expect: [{where: {rule: none}, metric: counts.frames, at_least: 1}]\n");
  const AblationState state = run(grid, "out");
  EXPECT_THAT(
      cell(grid, state, 0).reason,
      StartsWith("2 of 4 frames had an error, more than max_failed (0); the first: frame 1"));
  EXPECT_TRUE(cell(grid, state, 1).done());
  EXPECT_THAT(cell(grid, state, 2).reason, EndsWith("(on_error: stop)"));
  EXPECT_EQ(line_of(grid, 2).at("metrics").at("counts").at("frames"), 2);
  EXPECT_FALSE(judge(state.results, state.results.plan.expectations[0]).met)
      << "a cell that failed meets nothing, whatever was measured of it";
  const auto results = read_results(path("out"));
  ASSERT_TRUE(results);
  EXPECT_EQ(results->record(results->plan.cells[0]).outcome, CellOutcome::failed);
  EXPECT_FALSE(judge(*results, results->plan.expectations[0]).met)
      << "and the report says the same";
}

TEST_F(Trust, AnOldLineWithFramesInErrorIsAFailure) {
  Grid grid = expand("data: {all: {set: {solvers.error_at: [0]}}}\n");
  run(grid, "out");
  change_line(0, [](std::string& line) {
    json old = json::parse(line);
    old["schema"] = "weft.cell/1";
    old["outcome"] = "done";
    old["reason"] = "";
    old.erase("check");
    line = old.dump();
  });
  const AblationState state = *state_of(grid, *ResultsFolder::look(path("out"), "plan"), {});
  EXPECT_EQ(state.failed, 1U);
  EXPECT_EQ(state.results.records.unchecked, 1U);
  EXPECT_EQ(cell(grid, state, 0).reason, "1 of 2 frames had an error, more than max_failed (0)");
  const auto results = read_results(path("out"));
  ASSERT_TRUE(results);
  EXPECT_EQ(results->record(results->plan.cells[0]).reason, cell(grid, state, 0).reason);
}

TEST_F(Trust, ACellWhoseDataChangedWhileItRanHasNoResult) {
  std::ofstream(path("data")) << "before";
  Grid grid = expand("data: {all: {set: {source.frames: 20, source.sleep_ms: 10, source.path: " +
                     path("data") + "}}}\n");
  const auto folder = ResultsFolder::open(path("out"), "plan");
  const auto change = [&](double share) {
    if (share > 0.0) std::ofstream(path("data")) << "after it";
  };
  const auto state =
      run_ablation(grid, *folder, *local_engine(1), {}, change, std::atomic<bool>{false});
  ASSERT_TRUE(state) << state.error().message;
  EXPECT_EQ(state->left, 1U);
  EXPECT_THAT(state->reasons,
              ElementsAre(HasSubstr("its data changed while it ran: " + path("data"))));
  EXPECT_TRUE(lines("out").empty());
}

TEST_F(Trust, AFileThatIsWrittenAnewWithTheSameContentIsNoChange) {
  std::ofstream(path("data")) << "before";
  Grid grid = expand("data: {all: {set: {source.path: " + path("data") + "}}}\n");
  fs::remove(path("data"));
  std::ofstream(path("data")) << "before";
  EXPECT_EQ(run(grid, "out").done, 1U);
}

TEST_F(Trust, ADataFileThatIsGoneBeforeItsCellStartsLeavesTheCell) {
  std::ofstream(path("data")) << "before";
  Grid grid = expand("data: {all: {set: {source.path: " + path("data") + "}}, good: {}}\n");
  fs::remove(path("data"));
  const AblationState state = run(grid, "out");
  EXPECT_EQ(state.done, 1U);
  EXPECT_EQ(state.left, 1U);
  EXPECT_THAT(state.reasons, ElementsAre(HasSubstr("there is no file " + path("data"))));
}

TEST_F(Trust, WhatIsNotTheCellsOwnFailureIsNoResult) {
  Grid grid = expand(
      "axes:\n  fault:\n    values:\n      none: {}\n"
      "      memory: {set: {solvers.no_memory_at: [1]}}\n"
      "      absent: {set: {solvers.absent: true}}\n"
      "data: {all: {}, lost: {set: {source.gone_at: [1]}}, gone: {set: {source.absent: true}}}\n");
  const AblationState state = run(grid, "out");
  EXPECT_EQ(state.done, 1U);
  EXPECT_EQ(state.failed, 0U);
  EXPECT_EQ(state.left, 8U);
  std::string reasons;
  for (const std::string& reason : state.reasons) reasons += reason + "\n";
  for (const char* part :
       {"solvers: solvers/test.scripted: out of memory", "its file is gone, as scripted",
        "the first: frame 1, sources: sources/test.scripted: scripted loss"}) {
    EXPECT_THAT(reasons, HasSubstr(part));
  }
  for (const Cell& each : grid.cells()) {
    if (each.data == 0 && each.values[0] == 0) continue;
    EXPECT_THAT(reasons, HasSubstr(each.identity.key));
  }
  EXPECT_EQ(lines("out").size(), 1U);
}

TEST_F(Trust, RunsFailedCellsAgainWithTheOption) {
  const std::string plan = write_plan(
      "axes:\n  solver: {values: {good: {}, bad: {set: {solvers.error_at: [0]}}}}\n"
      "data: {all: {}}\n");
  EXPECT_EQ(weft({"ablate", plan, "--out", path("out")}).exit_code, 1);
  EXPECT_EQ(weft({"ablate", plan, "--out", path("out")}).exit_code, 1);
  EXPECT_EQ(lines("out").size(), 2U) << "a failure is a result";
  EXPECT_EQ(weft({"ablate", plan, "--out", path("out"), "--retry", "failed"}).exit_code, 1);
  const auto stored = read_cell_records(path("out"), {});
  ASSERT_TRUE(stored);
  EXPECT_EQ(stored->cells.size(), 2U);
  std::map<std::string, int> files;
  for (const auto& [key, known] : stored->cells) ++files[known.place.file];
  EXPECT_EQ(files,
            (std::map<std::string, int>{{"cached-000001.jsonl", 1}, {"cached-000002.jsonl", 1}}));
  EXPECT_TRUE(fs::exists(path("out/results/withdrawn-000001.jsonl")));
  EXPECT_EQ(read_results(path("out"))->records.cells.size(), 2U);
}

TEST_F(Trust, AResultThatWasWithdrawnIsMissingUntilItsCellRanAgain) {
  Grid grid = expand("data: {all: {set: {solvers.error_at: [0]}}}\n");
  run(grid, "out");
  AblationOptions retry;
  retry.retry_failed = true;
  const AblationState stopped = run(grid, "out", 1, retry, -1.0);  // killed before its first cell
  EXPECT_EQ(stopped.left, 1U);
  EXPECT_EQ(run(grid, "out").failed, 1U) << "an ordinary run goes on";
  EXPECT_EQ(read_results(path("out"))->records.cells.size(), 1U);
}

TEST_F(Trust, ListsEachChangedLineAndRunsItsCellAgainWithTheOption) {
  const std::string plan = write_plan(kTwo);
  ASSERT_EQ(weft({"ablate", plan, "--out", path("out")}).exit_code, 0);
  const std::size_t size = weft::testing::read_lines(file())[1].size();
  constexpr std::size_t kStep = 61;
  for (std::size_t at = 0; at < size; at += kStep) {
    const auto flip = [&](std::string& line) { line[at] = static_cast<char>(line[at] ^ 1); };
    change_line(1, flip);
    const auto stored = read_cell_records(path("out"), {});
    ASSERT_TRUE(stored) << at << ": " << stored.error().message;
    ASSERT_EQ(stored->damaged.size(), 1U) << at;
    EXPECT_EQ(stored->damaged.at(0).where, file() + ":2") << at;
    EXPECT_EQ(read_results(path("out"))->records.damaged.size(), stored->damaged.size());
    change_line(1, flip);
  }
  ASSERT_EQ(weft({"ablate", plan, "--out", path("out"), "--status"}).exit_code, 0);
  change_line(1, [](std::string& line) { line[line.find("solved_percent") + 17] = '7'; });
  const auto named = weft({"ablate", plan, "--out", path("out"), "--status"});
  EXPECT_EQ(named.exit_code, 1);
  EXPECT_THAT(named.out, HasSubstr("1 done, 0 failed, 1 damaged, 0 left"));
  EXPECT_THAT(named.out, HasSubstr("cached-000001.jsonl:2: it was changed after it was written"));
  EXPECT_EQ(weft({"ablate", plan, "--out", path("out")}).exit_code, 1);
  EXPECT_EQ(lines("out").size(), 2U) << "nothing runs again unasked";
  EXPECT_EQ(weft({"ablate", plan, "--out", path("out"), "--retry", "damaged"}).exit_code, 0);
  EXPECT_EQ(weft({"ablate", plan, "--out", path("out"), "--status"}).exit_code, 0);
}

TEST_F(Trust, NoticesWhatIsMissingOfACellsFolder) {
  Grid grid = expand(kTwo);
  run(grid, "out");
  const std::string cut = path("out/cells/" + grid.cells()[0].identity.key + "/shapes.npz");
  fs::resize_file(cut, fs::file_size(cut) - 1);
  fs::remove_all(path("out/cells/" + grid.cells()[1].identity.key));
  AblationState state = run(grid, "out");
  EXPECT_EQ(state.damaged, 2U);
  std::string said;
  for (const Damage& damage : state.results.records.damaged) said += damage.what + "\n";
  EXPECT_THAT(said, HasSubstr("shapes.npz has "));
  EXPECT_THAT(said, HasSubstr("pipeline.yaml is missing"));
  EXPECT_EQ(read_results(path("out"))->records.damaged.size(), 2U);
  AblationOptions retry;
  retry.retry_damaged = true;
  state = run(grid, "out", 1, retry);
  EXPECT_EQ(state.done, 2U);
  EXPECT_TRUE(state.results.records.damaged.empty());
}

TEST_F(Trust, FindsAFileThatWasChangedInItsPlaceWhenDamageIsToBeRetried) {
  Grid grid = expand("data: {all: {}}\n");
  run(grid, "out");
  const std::string yaml = path("out/cells/" + grid.cells()[0].identity.key + "/pipeline.yaml");
  std::string text = weft::testing::read_text(yaml);
  const std::string good = text;
  text[text.size() / 2] = '#';
  std::ofstream(yaml) << text;
  const std::string begun = yaml + ".part.o2j4ge";
  std::ofstream(begun) << "begun by a process that met a full disk";
  AblationOptions retry;
  retry.retry_damaged = true;
  EXPECT_EQ(run(grid, "out", 1, retry).done, 1U);
  EXPECT_EQ(weft::testing::read_text(yaml), good);
  EXPECT_FALSE(fs::exists(begun));
  EXPECT_EQ(lines("out").size(), 3U) << "the withdrawn line, the withdrawal, the new line";
}

TEST_F(Trust, AKeyThatIsNoneIsDamageAndNeverAPath) {
  Grid grid = expand("data: {all: {}}\n");
  run(grid, "out");
  const std::string key = grid.cells()[0].identity.key, crafted = "../../../../etc/passwd #0123456";
  change_line(0, [&](std::string& line) {
    line.replace(line.find(key), key.size(), crafted);
    line = checked_again(line);
  });
  const auto stored = read_cell_records(path("out"), {});
  ASSERT_TRUE(stored);
  ASSERT_EQ(stored->damaged.size(), 1U);
  EXPECT_THAT(stored->damaged[0].what, HasSubstr("32 hexadecimal digits"));
  EXPECT_TRUE(read_results(path("out"))->records.cells.empty());
  std::string plan = weft::testing::read_text(path("out/plan.json"));
  plan.replace(plan.find(key), key.size(), crafted);
  json unchecked = json::parse(plan);
  unchecked.erase("check");
  std::ofstream(path("out/plan.json")) << unchecked;
  const auto crafted_plan = read_results(path("out"));
  ASSERT_FALSE(crafted_plan);
  EXPECT_THAT(crafted_plan.error().message, HasSubstr("the key of cell 0"));
}

TEST_F(Trust, RefusesTheFolderOfAnotherPlanAndOneOfItsNameGoesOn) {
  Grid grid = expand(kTwo);
  run(grid, "out");
  for (const auto& refused : {ResultsFolder::open(path("out"), "other").error(),
                              ResultsFolder::look(path("out"), "other").error()}) {
    EXPECT_EQ(refused.code, Errc::invalid_value);
    EXPECT_THAT(refused.message, HasSubstr("holds the results of the plan 'plan'"));
  }
}

TEST_F(Trust, StatusCreatesNothing) {
  const std::string plan = write_plan(kTwo);
  const auto ended = weft({"ablate", plan, "--out", path("out"), "--status"});
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.out, HasSubstr("2 left"));
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(Trust, PlanNamesStayInTheirFolder) {
  for (const std::string name : {"../../x", "a/b", ".hidden", "..", "\"\"", "a b", "'x\\y'"}) {
    const std::string plan = write("weft: 1\nname: " + name + "\npipeline: " + WEFT_PLANS +
                                       "/base.yaml\ndata_use: tuning\ndata: {all: {}}\n",
                                   "named.yaml");
    const auto [read, report] = read_plan(plan, registry_);
    ASSERT_FALSE(report.ok()) << name;
    EXPECT_THAT(report.text(), HasSubstr("named.yaml:2:7: ")) << name;
  }
}

}  // namespace
}  // namespace weft::lab
