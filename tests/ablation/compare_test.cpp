// SPDX-License-Identifier: Apache-2.0
#include "ablation_fixture.hpp"
#include "support/child.hpp"

namespace weft::lab {
namespace {

using ::testing::HasSubstr;

class CompareCommand : public AblationTest {
 protected:
  CompareCommand() {
    write_pipeline("near", "0.3", "2");
    write_pipeline("far", "0.8", "2");
  }

  void write_pipeline(const std::string& name, const std::string& distance_m,
                      const std::string& frames) const {
    write("weft: 1\nextends: " WEFT_PLANS "/base.yaml\nsource: {params: {frames: " + frames +
              "}}\nstages: [{use: solvers/test.scripted, params: {distance_m: " + distance_m +
              "}}]\n",
          name + ".yaml");
  }

  weft::testing::Ended compare(std::vector<std::string> words) const {
    words.insert(words.begin(), {WEFT_PROGRAM, "--plugin-path", WEFT_TEST_PLUGINS, "compare",
                                 path("near.yaml"), path("far.yaml")});
    words.insert(words.end(), {"--out", path("out")});
    return weft::testing::Child(std::move(words), path("said")).wait();
  }
};

TEST_F(CompareCommand, NamesTheBetterPipelineWithEffectIntervalAndNumberOfSequences) {
  const auto ended = compare({"--seeds", "1-6", "--set", "data.own.seed_setting=source.frames"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr(" is better than "));
  EXPECT_THAT(ended.out, HasSubstr("95 % interval"));
  EXPECT_THAT(ended.out, HasSubstr("6 sequences"));
  EXPECT_THAT(ended.out, HasSubstr("p = 0.031"));  // 2 / 2^6
}

TEST_F(CompareCommand, SaysThatOneSequenceIsTooFew) {
  const auto ended = compare({});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("Too few sequences to compare near with far"));
}

TEST_F(CompareCommand, LeavesAPlanThatGivesTheSameCells) {
  ASSERT_EQ(compare({}).exit_code, 0);
  const auto again =
      weft::testing::Child({WEFT_PROGRAM, "--plugin-path", WEFT_TEST_PLUGINS, "ablate",
                            path("out.yaml"), "--out", path("out"), "--dry-run"},
                           path("said"))
          .wait();
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("2 cells (2 distinct): 2 done"));
}

TEST_F(CompareCommand, SaysInADryRunWhatWouldRunAndWritesNothing) {
  const auto ended = compare({"--dry-run"});
  EXPECT_EQ(ended.exit_code, 1) << ended.err;  // not finished, as of weft ablate
  EXPECT_THAT(ended.out, HasSubstr("2 cells (2 distinct): 0 done"));
  EXPECT_FALSE(fs::exists(path("out")));
  EXPECT_FALSE(fs::exists(path("out.yaml")));
}

TEST_F(CompareCommand, NamesTheArgumentInWhichAMistakeIs) {
  EXPECT_THAT(compare({"--data", path("nowhere")}).err,
              HasSubstr("error: --data " + path("nowhere") + ": there is no such file or folder"));
  EXPECT_THAT(compare({"--metric", "all.eror"}).err, HasSubstr("error: --metric all.eror: "));
  EXPECT_THAT(compare({"--seeds", "one"}).err, HasSubstr("error: --seeds one: "));
  EXPECT_FALSE(fs::exists(path("out.yaml")));
}

TEST_F(CompareCommand, ReadsDataThatAFileWithASourceNames) {
  write("source: {use: sources/test.scripted, params: {frames: 2}}\n", "more.yaml");
  const auto ended = compare({"--data", path("more.yaml"), "--dry-run"});
  EXPECT_THAT(ended.out, HasSubstr("2 cells")) << ended.err;
}

TEST_F(CompareCommand, RefusesPipelinesThatReadDifferentFrames) {
  write_pipeline("far", "0.8", "3");
  const auto ended = compare({});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.err, HasSubstr("different sources"));
  EXPECT_THAT(ended.err, HasSubstr("--data FOLDER"));
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(CompareCommand, SaysWhereThereIsNothingToCompare) {
  const auto ended = compare({"--set", "source.truth=false"});
  EXPECT_EQ(ended.exit_code, 3);
  EXPECT_THAT(ended.err, HasSubstr("no frame has a value of all.error_solved.mean_mm"));
  EXPECT_THAT(compare({"--metric", "all.eror"}).err, HasSubstr("all.eror"));
}

TEST_F(CompareCommand, RefusesAMissingFileAndAMistakeInAPipeline) {
  write("weft: 1\nextends: near.yaml\nstages: [{use: solvers/test.scriptd}]\n", "far.yaml");
  const auto ended = compare({});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.err, HasSubstr("no plugin 'solvers/test.scriptd'"));
  EXPECT_THAT(ended.err, HasSubstr("far.yaml:3:"));
  fs::remove(path("far.yaml"));
  EXPECT_EQ(compare({}).exit_code, 2);
}

/// A plan may list its pipelines itself.
class PipelinesOfAPlan : public CompareCommand {
 protected:
  std::string mistakes(const std::string& pipeline) const {
    return load_grid(write("weft: 1\nname: p\npipeline: " + pipeline +
                               "\ndata_use: tuning\ndata: {all: {}}\n",
                           "p.yaml"),
                     registry_, {})
        .second.text();
  }
};

TEST_F(PipelinesOfAPlan, AreItsFirstAxisWithTheCellsThatEachHasAlone) {
  const auto keys = [&](const std::string& pipeline) {
    auto [grid, report] = load_grid(write("weft: 1\nname: p\npipeline: " + pipeline +
                                              "\ndata_use: tuning\ndata: {all: {}}\naxes: {every: "
                                              "{set: filters.every, values: [2, 3]}}\n",
                                          "p.yaml"),
                                    registry_, {});
    EXPECT_TRUE(report.ok()) << report.text();
    std::vector<std::string> found;
    for (const Cell& cell : grid.cells()) found.push_back(cell.identity.key);
    return found;
  };
  std::vector<std::string> separately = keys("near.yaml");
  for (const std::string& key : keys("far.yaml")) separately.push_back(key);
  EXPECT_EQ(keys("{near: near.yaml, far: far.yaml}"), separately);
}

TEST_F(PipelinesOfAPlan, HaveFoldersOfTheirOwn) {
  // The same text in two folders, which name different files.
  for (const char* folder : {"a", "b"}) {
    fs::create_directories(path(folder));
    write_pipeline(std::string(folder) + "/base", std::string(folder) == "a" ? "0.2" : "0.4", "2");
    write("weft: 1\nextends: base.yaml\n", std::string(folder) + "/same.yaml");
  }
  auto [grid, report] = load_grid(write("weft: 1\nname: p\npipeline: {a: a/same.yaml, b: "
                                        "b/same.yaml}\ndata_use: tuning\ndata: {all: {}}\n",
                                        "p.yaml"),
                                  registry_, {});
  ASSERT_TRUE(report.ok()) << report.text();
  ASSERT_EQ(grid.cells().size(), 2U);
  EXPECT_NE(grid.cells()[0].identity.key, grid.cells()[1].identity.key);
}

TEST_F(PipelinesOfAPlan, AreRefusedWhereOneIsWrong) {
  EXPECT_THAT(mistakes("{near: near.yaml}"),
              HasSubstr("p.yaml:3:11: 'pipeline' must be a file, or"));
  EXPECT_THAT(mistakes("{near: near.yaml, far: fra.yaml}"),
              HasSubstr("p.yaml:3:34: 'pipeline': there is no file"));
}

}  // namespace
}  // namespace weft::lab
