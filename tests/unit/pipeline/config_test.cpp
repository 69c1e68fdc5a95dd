// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using testing::chain;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::head;
using ::testing::IsEmpty;
using testing::lines;
using ::testing::StartsWith;

class Config : public testing::PipelineTest {};

TEST_F(Config, ReadsEveryKey) {
  const auto [config, report] =
      load(chain({},
                 "seed: 18446744073\nlost_after: 0\non_error: stop\nmax_failed: 2\n"
                 "frames_at_once: 3\nthreads: 2\nrealtime: latest"));
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(config.seed, 18446744073U);
  EXPECT_EQ(config.lost_after, 0);
  EXPECT_TRUE(config.stop_on_error);
  EXPECT_EQ(config.max_failed, 2);
  EXPECT_EQ(config.frames_at_once, 3);
  EXPECT_EQ(config.threads, 2);
  EXPECT_TRUE(config.latest_only);
  EXPECT_EQ(config.source->component.component().id, "sources/test.scripted");
  EXPECT_EQ(config.templ->component.component().id, "templates/test.scripted");
  EXPECT_EQ(config.stages.size(), 6U);
  EXPECT_EQ(config.sinks.size(), 1U);
}

TEST_F(Config, HasTheDocumentedDefaults) {
  const auto [config, report] = load(head());
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(config.seed, 0U);
  EXPECT_EQ(config.lost_after, 30);
  EXPECT_FALSE(config.stop_on_error);
  EXPECT_EQ(config.max_failed, 0);
  EXPECT_EQ(config.frames_at_once, 0);
  EXPECT_EQ(config.threads, 0);
  EXPECT_FALSE(config.latest_only);
  EXPECT_THAT(config.stages, IsEmpty());
  EXPECT_THAT(config.sinks, IsEmpty());
}

TEST_F(Config, TakesEmptyListsForNoStages) {
  const auto report = load(head() + "stages:\nsinks: []\n").second;
  EXPECT_TRUE(report.ok()) << report.text();
}

TEST_F(Config, SuggestsTheNearestKeyOnEachLevel) {
  const auto report = load(
                          "weft: 1\n"
                          "sed: 4\n"
                          "source: {use: sources/test.scripted, parms: {}}\n"
                          "template: {use: templates/test.scripted, params: {colums: 4}}\n"
                          "stages:\n"
                          "  - use: matchers/test.pattern\n"
                          "    form: {keypoints: a}\n"
                          "  - use: filters/test.warped\n"
                          "    params: {warp: {use: warps/test.scripted, prams: {}}}\n"
                          "  - use: filters/test.warped\n"
                          "    params: {warp: {use: warps/test.scripted, params: {eror_at: [1]}}}\n"
                          "sinks:\n"
                          "  - {use: sinks/test.scripted, note: a}\n")
                          .second;
  EXPECT_THAT(
      lines(report),
      ElementsAre("2:1: a pipeline has no key 'sed'; did you mean 'seed'?",
                  "3:38: the source has no key 'parms'; did you mean 'params'?",
                  "4:51: templates/test.scripted has no parameter 'colums'; did you mean "
                  "'columns'?",
                  "7:5: a stage has no key 'form'; did you mean 'from'?",
                  StartsWith("9:47: a nested component has no key 'prams'"),
                  "11:56: warps/test.scripted has no parameter 'eror_at'; did you mean 'error_at'?",
                  "13:32: a sink has no key 'note'; it may have: use, params, as, from, isolate, "
                  "deadline_ms, overwrite"));
}

TEST_F(Config, RefusesComponentsInTheWrongPlace) {
  const auto report =
      load(
          "weft: 1\n"
          "source: {use: templates/test.scripted}\n"
          "template: {use: sources/test.scripted}\n"
          "stages:\n"
          "  - {use: sinks/test.scripted}\n"
          "  - {use: sources/test.scripted}\n"
          "  - {use: filters/test.warped, params: {warp: {use: solvers/test.scripted}}}\n"
          "sinks:\n"
          "  - {use: solvers/test.scripted}\n")
          .second;
  EXPECT_THAT(lines(report),
              ElementsAre("2:15: 'templates/test.scripted' cannot be the source; legal roles: "
                          "sources",
                          "3:17: 'sources/test.scripted' cannot be the template; legal roles: "
                          "templates",
                          StartsWith("5:11: 'sinks/test.scripted' cannot be a stage; legal roles: "
                                     "detectors, "),
                          StartsWith("6:11: 'sources/test.scripted' cannot be a stage"),
                          StartsWith("7:53: 'warp' must be one of warps/..."),
                          "9:11: 'solvers/test.scripted' cannot be a sink; legal roles: sinks"));
}

TEST_F(Config, NamesWhatIsMissing) {
  EXPECT_THAT(
      lines(load("seed: 1\n").second),
      ElementsAre("1:1: the key 'weft' is missing; begin the file with: weft: 1",
                  "1:1: the key 'source' is missing", "1:1: the key 'template' is missing"));
  EXPECT_THAT(lines(load(head() + "stages:\n  - {as: a}\n  - 4\n").second),
              ElementsAre("5:5: a stage lacks the key 'use'",
                          StartsWith("6:5: a stage must be a component, such as {use: ")));
  EXPECT_THAT(lines(load("").second),
              ElementsAre("1:1: a pipeline is a map with the keys weft, source, template, stages"));
}

TEST_F(Config, RefusesOptionsOutOfRange) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"seed: -1", "'seed' must be a whole number from 0 to"},
      {"seed: 1.5", "'seed' must be a whole number"},
      {"seed: 9223372036854775808", "'seed' must be a whole number"},
      {"lost_after: -1", "'lost_after' must be a whole number from 0 to 1000000"},
      {"lost_after: '3'", "'lost_after' must be a whole number"},
      {"max_failed: many", "'max_failed' must be a whole number"},
      {"max_failed:", "'max_failed' must be a whole number"},
      {"frames_at_once: 65", "'frames_at_once' must be a whole number from 0 to 64"},
      {"threads: -1", "'threads' must be a whole number from 0 to 256"},
      {"on_error: skip", "'on_error' must be one of: continue, stop"},
      {"on_error: [stop]", "'on_error' must be one of: continue, stop"},
      {"realtime: newest", "'realtime' must be one of: all, latest"},
      {"realtime:", "'realtime' must be one of: all, latest"}};
  for (const auto& [option, message] : cases) {
    EXPECT_THAT(lines(load(chain({}, option)).second), ElementsAre(HasSubstr(message))) << option;
  }
  EXPECT_THAT(lines(load("weft: 2\n" + head().substr(8)).second),
              ElementsAre("1:7: 'weft' must be 1, the version of the pipeline format"));
}

TEST_F(Config, ReportsAllMistakesInOnePassInTheOrderOfTheFile) {
  const auto report =
      check(
          "weft: 1\n"
          "lost_after: x\n"
          "sinks: 3\n"
          "stages:\n"
          "  - {use: filters/test.scriptd, as: 'Ü', from: 4}\n"
          "  - {use: filters/test.scripted, params: {every: 2000}, params: 1}\n"
          "template: {use: templates/test.scripted, params: {defect: tear}}\n"
          "source: {use: sources/test.scripted, params: {focal_px: 3 mm, truth: yes}}\n")
          .second;
  EXPECT_THAT(lines(report),
              ElementsAre(StartsWith("2:13: 'lost_after'"), StartsWith("3:8: 'sinks' must be a"),
                          "5:11: no plugin 'filters/test.scriptd' is installed; did you mean "
                          "'filters/test.scripted'?",
                          StartsWith("5:37: 'as' must be"), StartsWith("5:48: 'from' must be"),
                          "6:50: 'every' is 2000, legal is 0 to 1000",
                          StartsWith("6:57: duplicate key 'params'"),
                          StartsWith("7:59: 'defect' must be one of: none, index"),
                          "8:57: 'focal_px' must be a number in px (without the unit), not '3 mm'",
                          "8:70: 'truth' must be true or false, not 'yes'"));
}

TEST_F(Config, ReportsWiringTogetherWithWrongParameters) {
  const auto report = check(head("{frames: -1}") +
                            "stages:\n"
                            "  - {use: solvers/test.scripted}\n")
                          .second;
  EXPECT_THAT(lines(report),
              ElementsAre(StartsWith("2:55: 'frames' is -1, legal is 0 to"),
                          StartsWith("5:5: solvers/test.scripted requires 'sightlines'")));
}

TEST_F(Config, LeavesTheWiringAloneWhereAStageIsUnknown) {
  const auto report = check(head() +
                            "stages:\n"
                            "  - {use: passes/unknown}\n"
                            "  - {use: solvers/test.scripted}\n")
                          .second;
  EXPECT_THAT(lines(report), ElementsAre(HasSubstr("no plugin 'passes/unknown' is installed")));
}

TEST_F(Config, StillChecksTheWiringWhereANameIsAmbiguous) {
  const auto report =
      check(head() + "stages:\n  - {use: solvers/test.scripted, as: a, as: b}\n").second;
  EXPECT_THAT(lines(report), ElementsAre(HasSubstr("requires 'sightlines'"),
                                         StartsWith("5:41: duplicate key 'as'")));
}

TEST_F(Config, ReportsASyntaxErrorAlone) {
  const auto report = load("wef: 2\nsource: {use: sources/test.scripted\nstages: [\n").second;
  ASSERT_EQ(report.problems.size(), 1U) << report.text();
  EXPECT_EQ(report.problems[0].at.line, 3);
  EXPECT_THAT(report.text(), StartsWith(path("pipeline.yaml") + ":3:"));
  EXPECT_TRUE(report.unclear_stages);
}

TEST_F(Config, KnowsTheKeysThatLayFilesOverOneAnother) {
  EXPECT_THAT(lines(load(head() + "extend: base.yaml\n").second),
              ElementsAre("4:1: a pipeline has no key 'extend'; did you mean 'extends'?"));
  EXPECT_THAT(lines(load(head() + "withuot: [sinks]\n").second),
              ElementsAre("4:1: a pipeline has no key 'withuot'; did you mean 'without'?"));
  EXPECT_THAT(
      lines(load(head() + "zzz: 1\n").second),
      ElementsAre(::testing::EndsWith("threads, budget_ms, realtime, sequence, extends, without")));
}

TEST_F(Config, SaysWhyAFileCannotBeRead) {
  const auto text = [&](const std::string& file) {
    return load_pipeline(file, registry_, path("run")).second.text();
  };
  EXPECT_EQ(text(path("missing.yaml")),
            path("missing.yaml") + ": there is no such file; correct its name\n");
  EXPECT_EQ(text(folder_), folder_ + ": is a folder, no file; correct its name\n");
  const std::string locked = write(chain(), "locked.yaml");
  std::filesystem::permissions(locked, std::filesystem::perms::none);
  if (std::ifstream(locked)) GTEST_SKIP() << "this user may read everything";
  EXPECT_EQ(text(locked), locked + ": cannot be read: Permission denied\n");
}

TEST_F(Config, ResolvesPathsAgainstTheFileAndRefusesMissingOnes) {
  write("x", "note.txt");
  const auto [config, good] = load(chain({{"sources", "{path: note.txt}"}}));
  ASSERT_TRUE(good.ok()) << good.text();
  EXPECT_EQ(config.source->component.effective.find("params")->find("path")->scalar,
            path("note.txt"));
  EXPECT_THAT(lines(load(chain({{"sources", "{path: nota.txt}"}})).second),
              ElementsAre("2:53: 'path': there is no file " + path("nota.txt")));
  EXPECT_THAT(
      lines(load(chain({{"sources", "{path: \"${WEFT_NOT_SET_ANYWHERE}/x\"}"}})).second),
      ElementsAre(StartsWith("2:53: the variable WEFT_NOT_SET_ANYWHERE is not set; set it")));
}

TEST_F(Config, ComesBackFromItsEffectiveForm) {
  write("x", "note.txt");
  const auto [config, report] = load(
      "weft: 1\nseed: 5\nlost_after: 7\nmax_failed: 3\non_error: stop\n"
      "source:\n"
      "  use: sources/test.scripted\n"
      "  params: {path: note.txt, note: \"0x10: 'no' # \\n yes\", error_at: [1, 2.5e0]}\n"
      "template: {use: templates/test.scripted, params: {defect: none, columns: 0x8}}\n"
      "stages:\n"
      "  - {use: detectors/test.scripted, as: \"null\", template_params: {count: 40}}\n"
      "  - {use: matchers/test.scripted, as: '12', from: {keypoints: \"null\"}}\n"
      "  - {use: matchers/test.pattern, as: b}\n"
      "  - {use: matchers/test.merge, from: {correspondences: ['12', b]}}\n"
      "  - {use: filters/test.warped, params: {warp: {use: warps/test.scripted, params: {nan_at: "
      "[4]}}}}\n"
      "  - {use: filters/test.warped}\n"
      "sinks:\n"
      "  - {use: sinks/test.scripted, params: {path: lines.txt}, from: {correspondences: b}}\n");
  ASSERT_TRUE(report.ok()) << report.text();
  const std::string effective = effective_yaml(config);
  std::filesystem::create_directory(path("elsewhere"));
  const std::string copy = write(effective, "elsewhere/pipeline.yaml");
  const auto [again, second] = load_pipeline(copy, registry_, path("other_run"));
  ASSERT_TRUE(second.ok()) << second.text() << effective;
  EXPECT_EQ(effective_yaml(again), effective);
  EXPECT_EQ(again.seed, config.seed);
  EXPECT_EQ(again.stages[0].name, "null");
  EXPECT_TRUE(again.stages[0].on_template);
  EXPECT_THAT(again.stages[3].from[0].names, ElementsAre("12", "b"));
  EXPECT_THAT(effective, HasSubstr("use: warps/test.scripted"));
  EXPECT_THAT(effective, HasSubstr(path("note.txt")));
}

}  // namespace
}  // namespace weft
