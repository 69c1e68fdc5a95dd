// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using testing::chain;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// The resolved stages, as "name=id{param=value}".
std::vector<std::string> names_and_ids(const std::vector<StageConfig>& stages) {
  std::vector<std::string> result;
  for (const StageConfig& stage : stages) {
    result.push_back(stage.name + "=" + stage.component.component().id);
  }
  return result;
}

std::string parameter(const StageConfig& stage, const char* name) {
  return stage.component.effective.find("params")->find(name)->scalar;
}

class Documents : public testing::PipelineTest {
 protected:
  Documents() { write(chain({{"filters", "{every: 3}"}}, "seed: 5"), "base.yaml"); }

  std::pair<PipelineConfig, ConfigReport> over(const std::string& text,
                                               const std::vector<std::string>& settings = {}) {
    return load_pipeline(write("weft: 1\nextends: base.yaml\n" + text), registry_, path("run"),
                         settings);
  }
  std::pair<PipelineConfig, ConfigReport> set(const std::vector<std::string>& settings) {
    return load_pipeline(path("base.yaml"), registry_, path("run"), settings);
  }
};

TEST_F(Documents, AnEmptyExtensionIsTheFileThatItExtends) {
  const auto [config, report] = over("");
  ASSERT_TRUE(report.ok()) << report.text();
  const auto [base, ignored] = set({});
  EXPECT_EQ(effective_yaml(config), effective_yaml(base));
}

TEST_F(Documents, MergesStagesByNameAndKeysByKey) {
  const auto [config, report] = over(
      "seed: 6\n"
      "source: {params: {frames: 9}}\n"
      "stages:\n"
      "  - {as: filters, params: {every: 4}}\n"
      "  - {use: solvers/test.scripted, params: {distance_m: 2}}\n");
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(config.seed, 6U);
  EXPECT_EQ(parameter(*config.source, "frames"), "9");
  EXPECT_THAT(names_and_ids(config.stages),
              ElementsAre("detectors=detectors/test.scripted", "matchers=matchers/test.scripted",
                          "filters=filters/test.scripted", "warps=warps/test.scripted",
                          "passes=passes/test.scripted", "solvers=solvers/test.scripted"));
  EXPECT_EQ(parameter(config.stages[2], "every"), "4");
  EXPECT_EQ(parameter(config.stages[5], "distance_m"), "2");
  EXPECT_FALSE(config.stages[2].named);
}

TEST_F(Documents, DropsTheParametersOfAPluginThatIsReplaced) {
  const auto [config, report] = over("stages:\n  - {use: filters/test.warped}\n");
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(config.stages[2].component.component().id, "filters/test.warped");
}

TEST_F(Documents, PutsNewStagesBehindTheOneListedBeforeThem) {
  const auto [config, report] = over(
      "stages:\n"
      "  - {use: filters/test.scripted}\n"
      "  - {use: filters/test.warped, as: second}\n"
      "  - {use: filters/test.scripted, as: third}\n");
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_THAT(names_and_ids(config.stages),
              ElementsAre("detectors=detectors/test.scripted", "matchers=matchers/test.scripted",
                          "filters=filters/test.scripted", "second=filters/test.warped",
                          "third=filters/test.scripted", "warps=warps/test.scripted",
                          "passes=passes/test.scripted", "solvers=solvers/test.scripted"));
}

TEST_F(Documents, PutsNewStagesThatAreListedFirstBeforeTheOneListedAfterThem) {
  const auto [config, report] = over(
      "stages:\n"
      "  - {use: matchers/test.pattern, as: before}\n"
      "  - {use: matchers/test.pattern, as: next}\n"
      "  - {use: matchers/test.scripted, params: {}}\n");
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(config.stages[0].name, "detectors");
  EXPECT_EQ(config.stages[1].name, "before");
  EXPECT_EQ(config.stages[2].name, "next");
  EXPECT_EQ(config.stages[3].name, "matchers");
}

TEST_F(Documents, AppendsANewStageWithoutNeighbours) {
  const auto [config, report] = over("stages:\n  - {use: solvers/test.scripted, as: again}\n");
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(names_and_ids(config.stages).back(), "again=solvers/test.scripted");
}

TEST_F(Documents, LeavesOutWhatTheExtensionDoesWithout) {
  const auto [config, report] = over("without: [sinks, filters]\n");
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_TRUE(config.sinks.empty());
  EXPECT_EQ(config.stages.size(), 5U);
}

TEST_F(Documents, SayWhichFileLeftOutWhatIsMissing) {
  write("weft: 1\nextends: base.yaml\nwithout:\n  - sinks\n  - warps\n", "poor.yaml");
  const auto check_over = [&](const std::string& text) {
    return check("weft: 1\nextends: poor.yaml\n" + text).second.text();
  };
  EXPECT_EQ(check_over(""), path("base.yaml") +
                                ":10:5: passes/test.scripted requires 'warp_samples', which no "
                                "earlier stage produces ('warps' is omitted by " +
                                path("poor.yaml") +
                                ":5);\n    add one that produces it: warps/test.scripted\n");
  EXPECT_THAT(check_over("stages:\n  - {as: passes, from: {warp_samples: warps}}\n"),
              HasSubstr(":4:25: 'warps' is omitted by " + path("poor.yaml") + ":5\n"));
  EXPECT_EQ(check_over("stages:\n  - {as: filters}\n  - {use: warps/test.scripted}\n"), "");
}

TEST_F(Documents, LeavesOutStagesByTheNamesThatTheyHadBefore) {
  write(chain() + "  - {use: sinks/test.scripted}\n  - {use: sinks/test.visibility}\n",
        "base.yaml");
  const auto [config, report] = over("without: [sinks, sinks#2, sinks#3]\n");
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_TRUE(config.sinks.empty());
}

TEST_F(Documents, NameSinksLikeStages) {
  std::string text = chain();
  text += "  - {use: sinks/test.scripted, as: second, params: {path: b.txt}}\n";
  text += "  - {use: sinks/test.visibility, as: third}\n";
  write(text, "base.yaml");
  const auto [config, report] = over("without: [sinks]\nsinks:\n  - {as: third}\n",
                                     {"second.path=c.txt", "second.from={shape: solvers}"});
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_THAT(names_and_ids(config.sinks),
              ElementsAre("second=sinks/test.scripted", "third=sinks/test.visibility"));
  EXPECT_EQ(parameter(config.sinks[0], "path"), "c.txt");
  EXPECT_TRUE(config.sinks[0].named);
  const auto [again, second] = load(effective_yaml(config));
  ASSERT_TRUE(second.ok()) << second.text();
  EXPECT_EQ(again.sinks[0].name, "second");
}

TEST_F(Documents, RefusesToDoWithoutWhatIsNotThere) {
  EXPECT_THAT(testing::lines(over("without: [sink]\n").second),
              ElementsAre("3:11: the extended file has no stage or sink 'sink'; did you mean "
                          "'sinks'?"));
  EXPECT_THAT(testing::lines(over("without: sinks\n").second),
              ElementsAre(StartsWith("3:10: 'without' must be a list of names")));
  EXPECT_THAT(testing::lines(load(chain({}, "without: [sinks]")).second),
              ElementsAre(StartsWith("2:10: 'without' needs 'extends'")));
}

TEST_F(Documents, ReportsTheFileThatContainsAnError) {
  write(chain({{"filters", "{evry: 3}"}}), "base.yaml");
  const auto report = over("seed: -1\n").second;
  EXPECT_THAT(report.text(), StartsWith(path("pipeline.yaml") + ":3:7: 'seed' must be"));
  EXPECT_THAT(report.text(), HasSubstr(path("base.yaml") + ":7:43: filters/test.scripted has no"));
}

TEST_F(Documents, ResolvesPathsAgainstTheFileThatContainsThem) {
  std::filesystem::create_directories(path("far"));
  write("x", "far/there.txt");
  write("x", "here.txt");
  write(chain({{"sources", "{path: there.txt}"}}), "far/base.yaml");
  const auto [config, report] = load("weft: 1\nextends: far/base.yaml\n");
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(parameter(*config.source, "path"), path("far/there.txt"));
  const auto [own, second] =
      load("weft: 1\nextends: far/base.yaml\nsource: {params: {path: here.txt}}\n");
  ASSERT_TRUE(second.ok()) << second.text();
  EXPECT_EQ(parameter(*own.source, "path"), path("here.txt"));
}

TEST_F(Documents, RefusesAChainThatCannotBeFollowed) {
  EXPECT_THAT(testing::lines(load("weft: 1\nextends: none.yaml\n").second),
              ElementsAre("2:10: 'extends': there is no file " + path("none.yaml")));
  // An item without `use` may change a stage of the base, whose name may be that of a role.
  const std::string changed =
      "weft: 1\nextends: none.yaml\nstages: [{as: filters, params: {a: 1}}]\n";
  EXPECT_THAT(testing::lines(load(changed).second),
              ElementsAre("2:10: 'extends': there is no file " + path("none.yaml")));
  EXPECT_THAT(testing::lines(load("weft: 1\nextends: .\n").second),
              ElementsAre(::testing::EndsWith(": it is a folder")));
  EXPECT_THAT(testing::lines(load("weft: 1\nextends: [a]\n").second),
              ElementsAre(StartsWith("2:10: 'extends' must be the path")));
  EXPECT_THAT(testing::lines(load("weft: 1\nextends: \"${WEFT_NOT_SET_ANYWHERE}\"\n").second),
              ElementsAre(StartsWith("2:10: the variable WEFT_NOT_SET_ANYWHERE is not set")));
  write("weft: 1\nextends: pipeline.yaml\n", "base.yaml");
  EXPECT_THAT(over("").second.text(), path("base.yaml") + ":2:10: 'extends': " +
                                          path("pipeline.yaml") + " extends itself\n");
}

TEST_F(Documents, ChecksAnExtensionOfAFileThatCannotBeRead) {
  write("weft: [1\n", "base.yaml");
  const auto report = over("seed: -1\n").second;
  ASSERT_EQ(report.problems.size(), 2U) << report.text();
  EXPECT_THAT(report.text(), HasSubstr(path("pipeline.yaml") + ":3:7: 'seed' must be"));
  EXPECT_THAT(report.text(), HasSubstr("\n" + path("base.yaml") + ":"));
}

TEST_F(Documents, SetsParametersKeysAndPlugins) {
  write("x", "note.txt");
  const auto [config, report] =
      set({"seed=9", "filters.every=5", "solvers.params.distance_m=2.5", "source.frames=4",
           "source.path=" + path("note.txt"), "detectors.template_params.count=7",
           "warps.use=warps/test.scripted"});
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(config.seed, 9U);
  EXPECT_EQ(parameter(config.stages[2], "every"), "5");
  EXPECT_EQ(parameter(config.stages[5], "distance_m"), "2.5");
  EXPECT_EQ(parameter(*config.source, "frames"), "4");
  EXPECT_EQ(parameter(*config.source, "path"), path("note.txt"));
  ASSERT_TRUE(config.stages[0].on_template);
  EXPECT_EQ(config.sources.size(), 8U);
}

TEST_F(Documents, RefusesASettingOfWhichALaterOneLeavesNothing) {
  EXPECT_THAT(set({"filters.every=4", "filters.every=5"}).second.text(),
              StartsWith("--set filters.every=4, column 1: this setting has no effect"));
  EXPECT_THAT(set({"filters.every=4", "filters.use=filters/test.random"}).second.text(),
              StartsWith("--set filters.every=4, column 1: this setting has no effect"));
}

TEST_F(Documents, SetsParametersOfNestedComponents) {
  const auto [config, report] =
      set({"filters={use: filters/test.warped, params: {warp: {use: warps/test.scripted}}}",
           "filters.warp.nan_at=[4, 5]"});
  ASSERT_TRUE(report.ok()) << report.text();
  const yaml::Node& params = *config.stages[2].component.effective.find("params");
  EXPECT_EQ(params.find("warp")->find("params")->find("nan_at")->items.size(), 2U);
}

TEST_F(Documents, SetsParametersOfADefaultComponent) {
  const auto [config, report] =
      set({"filters={use: filters/test.warped}", "filters.warp.params.nan_at=[4, 5]"});
  ASSERT_TRUE(report.ok()) << report.text();
  const yaml::Node& warp = *config.stages[2].component.effective.find("params")->find("warp");
  EXPECT_EQ(warp.find("use")->scalar, "warps/test.scripted");
  EXPECT_EQ(warp.find("params")->find("nan_at")->items.size(), 2U);
  EXPECT_THAT(set({"filters={use: filters/test.warped}", "filters.warp.nan_at=[4]"}).second.text(),
              HasSubstr("did you mean 'warp.params.nan_at'?"));
}

TEST_F(Documents, NamesTheSettingAndItsColumn) {
  const auto text = [&](const std::string& setting) { return set({setting}).second.text(); };
  EXPECT_THAT(text("filters.evry=2"),
              "--set filters.evry=2, column 9: filters/test.scripted has no parameter 'evry'; did "
              "you mean 'every'?\n");
  EXPECT_THAT(text("filters.every=many"), StartsWith("--set filters.every=many, column 15: "));
  EXPECT_THAT(text("filtres.every=2"),
              StartsWith("--set filtres.every=2, column 1: no stage or sink is named 'filtres'; "
                         "did you mean 'filters'?"));
  EXPECT_THAT(text("sede=2"), StartsWith("--set sede=2, column 1: a pipeline has no key 'sede'"));
  EXPECT_THAT(text("seed"), StartsWith("--set seed, column 5: expected '='"));
  EXPECT_THAT(text("filters..every=2"), StartsWith("--set filters..every=2, column 9: expected a"));
  EXPECT_THAT(text("=2"), StartsWith("--set =2, column 1: expected a name"));
  EXPECT_THAT(text("filters.every=[2"), StartsWith("--set filters.every=[2, column 1"));
  EXPECT_THAT(text("filters.note={a: 1, a: 2}"), HasSubstr("column 21: "));
  EXPECT_THAT(text("source.päth=x"), StartsWith("--set source.päth=x, column 8: "));
  EXPECT_THAT(text("source.note=ä: {"), StartsWith("--set source.note=ä: {, column 1"));
}

TEST_F(Documents, RefusesSettingsOfWholeComponentsWithTheSettingThatIsMeant) {
  const auto text = [&](const std::string& setting) { return set({setting}).second.text(); };
  EXPECT_EQ(text("detectors=detectors/test.scripted"),
            "--set detectors=detectors/test.scripted, column 11: 'detectors' is a component; did "
            "you mean detectors.use=detectors/test.scripted?\n");
  EXPECT_THAT(text("source=sources/x"), HasSubstr("did you mean source.use=sources/x?"));
  EXPECT_THAT(text("sinks=sinks/x"), HasSubstr("did you mean sinks.use=sinks/x?"));
  EXPECT_EQ(text("filters=7"),
            "--set filters=7, column 9: 'filters' is a component; set a key or parameter of it: "
            "filters.KEY=VALUE\n");
  EXPECT_THAT(text("filters=[a]"), HasSubstr("'filters' is a component"));
  EXPECT_THAT(text("filters="), HasSubstr("'filters' is a component"));
}

TEST_F(Documents, RefusesSettingsOfWhatOnlyAFileSays) {
  for (const std::string key : {"extends", "stages"}) {
    EXPECT_EQ(set({key + "=[]", "seed=7"}).second.text(), "--set " + key +
                                                              "=[], column 1: a setting cannot "
                                                              "set '" +
                                                              key + "'; write it into a file\n");
  }
}

TEST_F(Documents, LeavesOutWhatASettingDoesWithout) {
  for (const std::string setting : {"without=filters,sinks", "without=[filters, sinks]"}) {
    const auto [config, report] = set({setting, "seed=7"});
    ASSERT_TRUE(report.ok()) << report.text();
    EXPECT_TRUE(config.sinks.empty());
    EXPECT_EQ(config.stages.size(), 5U);
  }
  EXPECT_EQ(set({"without=sinks,filtres"}).second.text(),
            "--set without=sinks,filtres, column 15: no stage or sink is named 'filtres'; did you "
            "mean 'filters'?\n");
  EXPECT_THAT(set({"without={filters: 1}"}).second.text(), HasSubstr("must be a list of names"));
  EXPECT_THAT(set({"without=filters", "filters.every=2"}).second.text(),
              HasSubstr("no stage or sink is named 'filters'"));
  EXPECT_THAT(set({"filters.every=2", "without=filters"}).second.text(),
              HasSubstr("this setting has no effect"));
}

TEST_F(Documents, CountsOnlyStagesWithoutANameWhenItNamesThem) {
  const auto document = yaml::parse(
      "[{use: filters/a}, {use: filters/b, as: mine}, {use: filters/a}, {use: warps/a}, 3]", "");
  EXPECT_THAT(names_of_stages(document->root),
              ElementsAre("filters", "mine", "filters#2", "warps", ""));
}

}  // namespace
}  // namespace weft
