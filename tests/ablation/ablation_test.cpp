// SPDX-License-Identifier: Apache-2.0
#include "ablation_fixture.hpp"
#include "lab/results/expectations.hpp"
#include "support/child.hpp"
#include "support/processes.hpp"

namespace weft::lab {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

using Ablation = AblationTest;

TEST_F(Ablation, ExecutesEachDistinctStageKeyOnce) {
  Grid grid = expand(kGrid);
  const AblationState state = run(grid, "out");
  EXPECT_EQ(state.cells, 32U);
  EXPECT_EQ(state.keys, 2U * (3U * 2U + 2U * 2U)) << "only the filter `chance` is random";
  EXPECT_EQ(state.left, 0U);
  std::map<std::string, int> executed;
  std::size_t stages = 0;
  for (const json& line : lines("out")) {
    std::map<std::string, std::string> keys;
    for (const json& stage : line.at("stages")) {
      keys[stage.at("stage")] = stage.at("key");
      executed.try_emplace(stage.at("key"), 0);
      ++stages;
    }
    for (const std::string stage : line.at("machine").at("executed")) ++executed[keys.at(stage)];
  }
  for (const auto& [key, times] : executed) EXPECT_EQ(times, 1) << key;
  EXPECT_EQ(state.stages, stages);
  EXPECT_EQ(state.stages_executed, executed.size());
  // Executed for each sequence: detector and matcher; warp, pass and two solvers without a filter.
  // Two of the four components that read the shape back run with `every` and with `off`. A filter,
  // a warp, a pass and two solvers run for each seed.
  EXPECT_EQ(executed.size(), 2U * (2U + 4U + 2U * 4U + 2U * 4U + 2U * 5U));
}

TEST_F(Ablation, GivesWhatTheSamePipelineGivesByItself) {
  Grid grid = expand(kGrid);
  const AblationState state = run(grid, "out");
  for (const std::size_t index : {0U, 9U, 17U, 30U}) {
    const std::string& key = grid.cells()[index].identity.key;
    const std::string file = path("out/cells/" + key + "/pipeline.yaml");
    const auto [pipeline, report] = check_pipeline(file, registry_of_all_, path(key));
    ASSERT_TRUE(report.ok()) << report.text();
    weft::testing::Ran ran;
    ASSERT_TRUE(run_pipeline(pipeline, path(key), ran, std::atomic<bool>{false}));
    const auto alone = evaluate_run(path(key));
    ASSERT_TRUE(alone) << alone.error().message;
    json expected = json::parse(to_json(*alone));
    expected["frames"] = json::array();
    json stored = line_of(grid, index).at("metrics");
    stored["frames"] = json::array();
    EXPECT_EQ(stored, expected) << index;
  }
}

TEST_F(Ablation, IdentifiesCellsByTheirPartsAsEachByItself) {
  const Grid grid = expand(kGrid);
  ASSERT_EQ(grid.cells().size(), 32U);
  for (const Cell& cell : grid.cells()) {
    const auto [pipeline, report] = grid.load(cell);
    ASSERT_TRUE(report.ok()) << report.text();
    std::vector<yaml::Problem> problems;
    const CellIdentity alone =
        Identifier().identify(pipeline, cell.seed, grid.plan().measurement, problems);
    EXPECT_EQ(cell.identity.key, alone.key);
    EXPECT_EQ(cell.identity.rebuilt_key, alone.rebuilt_key);
    EXPECT_EQ(cell.identity.group, alone.group);
    EXPECT_EQ(grid.stage_keys(pipeline), alone.stages);
    ASSERT_EQ(cell.stages.size(), pipeline.config.stages.size());
    EXPECT_EQ(cell.stages.back(), pipeline.config.stages.back().name);
  }
}

TEST_F(Ablation, IsTheSameForAnyNumberOfJobsAndWhenInterrupted) {
  Grid one = expand(kGrid), two = expand(kGrid), three = expand(kGrid);
  run(one, "one", 1);
  run(two, "two", 2);
  AblationState state = run(three, "three", 1, {}, 0.6);
  EXPECT_GT(state.left, 0U);
  EXPECT_GT(state.done, 0U);
  state = run(three, "three", 2);
  EXPECT_EQ(state.left, 0U);
  EXPECT_EQ(results("one"), results("two"));
  EXPECT_EQ(results("one"), results("three"));
}

TEST_F(Ablation, ExtendsAPlanWithoutRunningItsCellsAgain) {
  Grid small = expand("axes: {every: {set: filters.every, values: [2, 3]}}\ndata: {all: {}}\n");
  run(small, "out");
  Grid large = expand("axes: {every: {set: filters.every, values: [3, 4, 2]}}\ndata: {all: {}}\n");
  const AblationState state = run(large, "out");
  EXPECT_EQ(state.done, 3U);
  EXPECT_EQ(lines("out").size(), 3U);
}

TEST_F(Ablation, RecordsCellsThatFail) {
  Grid grid = expand(
      "axes:\n  solver:\n    values:\n      good: {}\n"
      "      refuses: {set: {solvers.refuse: true}}\n"
      "      errs: {set: {solvers.error_at: [0, 1]}}\n"
      "      errs_once: {set: {solvers.error_at: [0]}}\n"
      "data: {all: {}}\n");
  const AblationState state = run(grid, "out");
  EXPECT_EQ(state.done, 1U);
  EXPECT_EQ(state.failed, 3U);
  const auto reason = [&](std::size_t index) { return cell(grid, state, index).reason; };
  EXPECT_EQ(reason(1), "solvers/test.scripted: refuses as scripted");
  EXPECT_THAT(reason(2), StartsWith("every frame had an error; the first: frame 0, solvers: "));
  EXPECT_EQ(reason(3),
            "1 of 2 frames had an error, more than max_failed (0); the first: frame 0, solvers: "
            "solvers/test.scripted: scripted error");
  EXPECT_TRUE(line_of(grid, 1).at("metrics").is_null());
}

TEST_F(Ablation, TellsOfFramesInErrorInCellsThatAreDone) {
  Grid grid = expand(
      "axes:\n  solver:\n    values:\n      good: {}\n"
      "      errs_once: {set: {solvers.error_at: [1], max_failed: 1}}\n"
      "data: {all: {}}\n");
  const AblationState state = run(grid, "out");
  EXPECT_EQ(state.done, 2U);
  EXPECT_EQ(cell(grid, state, 0).frames_in_error, 0);
  EXPECT_EQ(cell(grid, state, 0).first_error, "");
  EXPECT_EQ(cell(grid, state, 1).frames_in_error, 1);
  EXPECT_EQ(cell(grid, state, 1).first_error,
            "frame 1, solvers: solvers/test.scripted: scripted error");
  EXPECT_THAT(summary_table(state.results), ::testing::HasSubstr("frames in error"));
}

TEST_F(Ablation, RecordsDataThatCannotBeRead) {
  Grid grid = expand(
      "data: {good: {}, bad: {set: {source.refuse: true}}, none: {set: "
      "{source.frames: 0}}}\n");
  const AblationState state = run(grid, "out", 2);
  EXPECT_EQ(state.done, 1U);
  EXPECT_EQ(cell(grid, state, 1).reason, "sources/test.scripted: refuses as scripted");
  EXPECT_EQ(cell(grid, state, 2).reason, "the source has no frames");
}

TEST_F(Ablation, SurvivesComponentsThatTakeTheirProcessWithThem) {
  const std::string deadly = "{set: {filters.use: filters/test_deadly, filters.deed: ";
  Grid grid = expand(
      "axes:\n  filter:\n    values:\n      good: {}\n"
      "      crash: " +
      deadly + "crash}}\n      abort: " + deadly +
      "abort}}\n"
      "      exit: " +
      deadly + "exit}}\n      early: " + deadly +
      "abort, filters.where: create}}\n"
      "data: {all: {}}\n");
  const AblationState state = run(grid, "out");
  EXPECT_EQ(state.done, 1U);
  EXPECT_EQ(state.failed, 4U);
  const auto reason = [&](std::size_t index) { return cell(grid, state, index).reason; };
  EXPECT_EQ(reason(1), "its process died of signal 11 (Segmentation fault)");
  EXPECT_EQ(reason(2), "its process died of signal 6 (Aborted)");
  EXPECT_EQ(reason(3), "it ended its process with exit code 7");
  EXPECT_EQ(reason(4), "its process died of signal 6 (Aborted)");
  EXPECT_THAT(weft::testing::read_text(path("out/log.txt")), HasSubstr("last words"));
}

TEST_F(Ablation, EndsWithACellWhateverItsComponentsHaveStarted) {
  const std::string name = "a" + std::to_string(getpid());
  const std::string deadly =
      "{set: {filters.use: filters/test_deadly, filters.child: " + name + ", filters.deed: ";
  Grid grid =
      expand("axes:\n  filter:\n    values:\n      good: {}\n      left: " + deadly +
             "leave}}\n      apart: " + deadly + "leave_session}}\n      copied: " + deadly +
             "fork_twice}}\n      many: " + deadly + "multiply}}\ndata: {all: {}}\n");
  const AblationState state = run(grid, "out");
  EXPECT_EQ(state.done, 2U);
  EXPECT_EQ(state.failed, 3U);
  const auto reason = [&](std::size_t index) { return cell(grid, state, index).reason; };
  EXPECT_EQ(reason(1), "its process died of signal 6 (Aborted)");
  EXPECT_EQ(reason(2), "its process died of signal 6 (Aborted)");
  EXPECT_EQ(reason(4), "it started more than 256 processes, and was ended with them");
  EXPECT_THAT(weft::testing::processes_named(name), ::testing::ElementsAre());
  EXPECT_EQ(lines("out").size(), 5U) << "a copy writes none";
}

TEST_F(Ablation, LeavesACellWhoseProcessIsKilledFromOutside) {
  Grid grid = expand(
      "axes:\n  filter:\n    values:\n      good: {}\n"
      "      killed: {set: {filters.use: filters/test_deadly, filters.deed: kill}}\n"
      "data: {all: {}}\n");
  const AblationState state = run(grid, "out");
  EXPECT_EQ(state.done, 1U);
  EXPECT_EQ(state.left, 1U);
  ASSERT_EQ(state.reasons.size(), 1U);
  EXPECT_THAT(state.reasons[0], HasSubstr("signal 9"));
}

TEST_F(Ablation, LeavesOutALineThatWasCutOff) {
  Grid grid = expand(kGrid);
  run(grid, "out");
  const std::size_t whole = lines("out").size();
  const std::string file = path("out/results/cached-000001.jsonl");
  fs::resize_file(file, fs::file_size(file) - 5);
  const auto stored = read_cell_records(path("out"), {});
  ASSERT_TRUE(stored);
  EXPECT_EQ(stored->cells.size(), whole - 1);
  EXPECT_TRUE(stored->damaged.empty()) << "a process was killed: nothing is wrong with that";
}

TEST_F(Ablation, RunsACellAgainWhoseLineWasCutOff) {
  Grid grid = expand("data: {all: {}}\n");
  run(grid, "out");
  const std::string file = path("out/results/cached-000001.jsonl");
  const std::string whole = weft::testing::read_text(file);
  fs::resize_file(file, fs::file_size(file) / 2);
  const AblationState state = run(grid, "out");
  EXPECT_EQ(state.done, 1U);
  json first = json::parse(whole);
  json second = json::parse(weft::testing::read_text(path("out/results/cached-000002.jsonl")));
  for (json* line : {&first, &second}) {
    line->at("machine").erase("seconds");
    line->erase("check");
  }
  EXPECT_EQ(first, second);
}

TEST_F(Ablation, RefusesFoldersThatAreNoneOfItsOwn) {
  fs::create_directories(path("other"));
  std::ofstream(path("other/thesis.tex")) << "all of it";
  const auto other = ResultsFolder::open(path("other"), "plan");
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("neither empty nor a results folder"));
  fs::create_directories(path("old"));
  std::ofstream(path("old/manifest.json")) << R"({"schema": "weft.results/0"})";
  const auto old = ResultsFolder::open(path("old"), "plan");
  ASSERT_FALSE(old);
  EXPECT_THAT(old.error().message, HasSubstr("'weft.results/0'"));
  std::ofstream(path("file")) << "";
  EXPECT_FALSE(ResultsFolder::open(path("file"), "plan"));
}

TEST_F(Ablation, KeepsTwoProgramsFromOneFolder) {
  const auto first = ResultsFolder::open(path("out"), "plan");
  ASSERT_TRUE(first);
  const auto second = ResultsFolder::open(path("out"), "plan");
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("in use"));
}

TEST_F(Ablation, ReusesResultsOfRebuiltComponentsOnlyWithTheOption) {
  Grid grid = expand("data: {all: {}}\n");
  run(grid, "out");
  const std::string key = grid.cells()[0].identity.key, old_key(32, 'a');
  std::string line = weft::testing::read_text(path("out/results/cached-000001.jsonl"));
  for (std::size_t at = line.find(key); at != std::string::npos; at = line.find(key)) {
    line.replace(at, key.size(), old_key);
  }
  line.pop_back();
  std::ofstream(path("out/results/cached-000001.jsonl")) << checked_again(line) << "\n";
  fs::rename(path("out/cells/" + key), path("out/cells/" + old_key));
  Grid accepted = expand("data: {all: {}}\n");
  EXPECT_EQ(run(accepted, "out", 1, {false, true, {}}).done, 1U);
  EXPECT_EQ(lines("out").size(), 1U);
  EXPECT_EQ(accepted.cells()[0].identity.key, old_key);
  EXPECT_EQ(json::parse(weft::testing::read_text(path("out/plan.json")))["cells"][0]["key"],
            old_key);
  run(grid, "out");
  EXPECT_EQ(lines("out").size(), 2U);
}

TEST_F(Ablation, SaysWhichNumberAnAxisSweeps) {
  const auto swept_by = [&](const std::string& axis, const std::string& name = "one") {
    Grid grid = expand("axes: {" + name + ": " + axis + "}\ndata: {all: {}}\n");
    const std::string folder = "out" + std::to_string(axis.size());
    run(grid, folder, 1, {}, 0.0);
    return json::parse(weft::testing::read_text(path(folder + "/plan.json")))["axes"][0];
  };
  const json listed = swept_by("{set: filters.every, values: [2, 3, 4]}", "every");
  EXPECT_EQ(listed["swept"], "every");
  EXPECT_EQ(listed["numbers"], json({2.0, 3.0, 4.0}));
  const json named = swept_by("{set: filters.every, values: {few: 7, some: 5, many: 4}}");
  EXPECT_EQ(named["swept"], "filters.every");
  EXPECT_EQ(named["numbers"], json({7.0, 5.0, 4.0}));
  const json mixed = swept_by(
      "{values: {none: {}, a: {set: {filters.every: 2}}, b: {set: {filters.every: 3}}, "
      "c: {set: {filters.every: 4}}, "
      "else: {set: {filters.use: filters/test.scripted, filters.every: 9}}}}");
  EXPECT_EQ(mixed["swept"], "filters.every");
  EXPECT_EQ(mixed["numbers"], json({nullptr, 2.0, 3.0, 4.0, nullptr}));
  EXPECT_FALSE(swept_by("{set: filters.every, values: [2, 3]}").contains("swept"))
      << "two numbers are no curve";
}

TEST_F(Ablation, SaysWhichNumbersTheFamiliesOfAnAxisSweep) {
  Grid grid = expand(
      "axes:\n"
      "  filter: {values: {none: {without: [filters]},\n"
      "    near_2: {set: {filters.every: 2}}, near_3: {set: {filters.every: 3}},\n"
      "    near_4: {set: {filters.every: 4}},\n"
      "    2: {set: {filters.use: filters/test.scripted, filters.every: 2}},\n"
      "    3: {set: {filters.use: filters/test.scripted, filters.every: 3}},\n"
      "    4: {set: {filters.use: filters/test.scripted, filters.every: 4}},\n"
      "    alone: {set: {filters.use: filters/test.scripted, seed: 4}}}}\n"
      "data: {all: {}}\n");
  run(grid, "out", 1, {}, 0.0);
  const json axis = json::parse(weft::testing::read_text(path("out/plan.json")))["axes"][0];
  EXPECT_EQ(axis["swept"], "filters.every");
  EXPECT_EQ(axis["numbers"], json({nullptr, 2.0, 3.0, 4.0, 2.0, 3.0, 4.0, nullptr}));
  EXPECT_EQ(axis["families"], json({"", "near", "near", "near", "filters.every", "filters.every",
                                    "filters.every", ""}));
}

TEST_F(Ablation, KeepsTimesOfCellsThatRanAlone) {
  Grid grid = expand("axes: {every: {set: filters.every, values: [2, 3]}}\ndata: {all: {}}\n");
  run(grid, "out");
  for (const json& line : lines("out")) EXPECT_EQ(line.at("timing"), json({{"cached", true}}));
  const AblationState timed = run(grid, "out", 1, {true, false, {}});
  EXPECT_EQ(timed.done, 2U);
  EXPECT_EQ(timed.stages_executed, timed.stages) << "nothing is shared";
  const std::vector<json> all = lines("out");
  ASSERT_EQ(all.size(), 4U);
  for (std::size_t i = 0; i < 2; ++i) {  // their files come first
    const json& stages = all[i].at("timing").at("stages");
    ASSERT_EQ(stages.size(), 6U);
    EXPECT_EQ(stages[0].at("stage"), "detectors");
    EXPECT_EQ(stages[0].at("frames"), 2);
    EXPECT_GT(stages[0].at("p95_ms"), 0.0);
    EXPECT_GT(stages[0].at("mean_processor_ms"), 0.0);
    EXPECT_EQ(all[i].at("metrics"), all[i + 2].at("metrics"));
  }
  run(grid, "out", 1, {true, false, {}});
  EXPECT_EQ(lines("out").size(), 4U);
}

TEST_F(Ablation, KeepsShapesOfFramesSpreadEvenly) {
  Grid grid = expand("data: {all: {set: {source.frames: 130}}}\n");
  run(grid, "out");
  const auto records =
      host::read_npz(path("out/cells/" + grid.cells()[0].identity.key + "/shapes.npz"));
  ASSERT_TRUE(records) << records.error().message;
  std::set<std::string> slots;
  for (const auto& [slot, record] : *records) slots.insert(slot);
  EXPECT_EQ(slots.size(), 1U + 2U * 33U) << "every fourth of 130";
  EXPECT_EQ(slots.count("000128.shape"), 1U);
  EXPECT_EQ(slots.count("000128.ground_truth"), 1U);
}

TEST_F(Ablation, JudgesWhatThePlanExpects) {
  Grid grid = expand(
      "axes: {every: {set: filters.every, values: [2, 3]}}\ndata: {all: {}}\n"
      "expect:\n"
      "  - {where: {every: 2}, metric: counts.frames, at_least: 2, at_most: 2}\n"
      "  - {metric: counts.frames, at_most: 1.5}\n"
      "  - {metric: jitter.mean_mm, at_most: 1}\n");
  const AblationState state = run(grid, "out");
  std::vector<ExpectationOutcome> outcomes;
  for (const PlanExpectation& expected : state.results.plan.expectations) {
    outcomes.push_back(judge(state.results, expected));
  }
  ASSERT_EQ(outcomes.size(), 3U);
  EXPECT_TRUE(outcomes[0].met);
  EXPECT_EQ(outcomes[0].cells, 1);
  EXPECT_FALSE(outcomes[1].met);
  EXPECT_EQ(outcomes[1].cells, 2);
  EXPECT_EQ(outcomes[1].mean, 2.0);
  EXPECT_FALSE(outcomes[2].met);
  EXPECT_EQ(outcomes[2].why_not, "a cell has no such figure") << "two frames have no jitter";
}

class AblateCommand : public AblationTest {
 protected:
  weft::testing::Ended ablate(std::vector<std::string> words) const {
    std::vector<std::string> command{WEFT_PROGRAM, "--plugin-path", WEFT_TEST_PLUGINS, "ablate"};
    command.insert(command.end(), words.begin(), words.end());
    return weft::testing::Child(command, path("printed")).wait();
  }
};

TEST_F(AblateCommand, RunsAPlanAndPrintsATable) {
  const std::string plan = write_plan(
      "axes: {every: {set: filters.every, values: [2, 3]}}\ndata: {all: {}}\n"
      "show: [counts.frames]\nexpect: [{metric: counts.frames, at_least: 2}]\n");
  const auto ended = ablate({plan, "--out", path("out"), "--jobs", "2"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("every  cells  failed  frames\n"
                                   "2          1       0       2\n"));
  EXPECT_THAT(ended.out, HasSubstr("2 cells (2 distinct): 2 done, 0 failed, 0 left"));
  EXPECT_THAT(ended.out, HasSubstr("met: counts.frames"));
  EXPECT_EQ(ablate({plan, "--out", path("out"), "--status"}).exit_code, 0);
}

TEST_F(AblateCommand, SaysBeforehandWhatIsLeft) {
  const std::string plan =
      write_plan("axes: {every: {set: filters.every, values: [2, 3]}}\ndata: {all: {}}\n");
  const auto first = ablate({plan, "--out", path("out"), "--dry-run"});
  EXPECT_EQ(first.exit_code, 1);
  EXPECT_THAT(first.out, HasSubstr("0 done, 0 failed, 2 left"));
  EXPECT_THAT(first.out,
              HasSubstr("  every: 2 (0 of 1), 3 (0 of 1)\n  data: all (0 of 2)\n"
                        "time: not known before the first cells are done here\ndisk: 0 B in "));
  EXPECT_FALSE(fs::exists(path("out")));
  ASSERT_EQ(ablate({plan, "--out", path("out"), "--without", "every.3"}).exit_code, 0);
  const auto half = ablate({plan, "--out", path("out"), "--dry-run"});
  EXPECT_THAT(half.out, HasSubstr("  every: 2 (1 of 1), 3 (0 of 1)\n  data: all (1 of 2)\n"
                                  "time: "));
  ASSERT_EQ(ablate({plan, "--out", path("out")}).exit_code, 0);
  const auto whole = ablate({plan, "--out", path("out"), "--dry-run"});
  EXPECT_EQ(whole.exit_code, 0);
  EXPECT_THAT(whole.out, ::testing::Not(HasSubstr("time: ")));
  EXPECT_THAT(whole.out, HasSubstr("disk: "));
}

TEST_F(AblateCommand, IsNotNeededToCheckAPlan) {
  const std::string axis = "axes: {every: {set: filters.every, values: [2, 3]}}\n";
  const auto check = [&](const std::string& file) {
    return weft::testing::Child({WEFT_PROGRAM, "--plugin-path", WEFT_TEST_PLUGINS, "check", file},
                                path("printed"))
        .wait();
  };
  const auto sound = check(
      write_plan(axis + "data: {all: {}, twice: {seeds: 1-2, seed_setting: source.frames}}\n"));
  EXPECT_EQ(sound.exit_code, 0) << sound.err;
  EXPECT_THAT(sound.out, HasSubstr(": ok, a plan of 6 cells\n"));
  const auto broken = check(write_plan(axis + "dta: {all: {}}\n"));
  EXPECT_EQ(broken.exit_code, 2);
  EXPECT_THAT(broken.err, HasSubstr("did you mean 'data'?"));
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(AblateCommand, FailsWhenAnExpectationIsMissed) {
  const std::string plan =
      write_plan("data: {all: {}}\nexpect: [{metric: counts.frames, at_least: 3}]\n");
  const auto ended = ablate({plan, "--out", path("out")});
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.out, HasSubstr("MISSED: counts.frames [] at least 3: mean 2 of 1 cells"));
}

TEST_F(AblateCommand, EndsWithCodeTwoBeforeAnyCell) {
  const std::string good = write_plan("data: {all: {}}\n");
  fs::create_directories(path("other"));
  std::ofstream(path("other/thesis.tex")) << "all of it";
  EXPECT_EQ(ablate({good, "--out", path("other")}).exit_code, 2);
  EXPECT_EQ(ablate({good, "--out", "/proc/nowhere"}).exit_code, 2);
  EXPECT_EQ(ablate({good, "--out", path("out"), "--set", "filters.evry=1"}).exit_code, 2);
  EXPECT_EQ(ablate({std::string(WEFT_PLANS) + "/wiring.yaml", "--out", path("out")}).exit_code, 2);
  EXPECT_FALSE(fs::exists(path("out")));
}

}  // namespace
}  // namespace weft::lab
