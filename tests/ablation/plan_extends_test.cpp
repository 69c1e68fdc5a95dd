// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "lab/ablation/plan/grid.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::lab {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Texts = std::vector<std::string>;

class PlanExtends : public weft::testing::PipelineTest {
 protected:
  PlanExtends() {
    write("weft: 1\nname: parent\npipeline: " + std::string(WEFT_PLANS) +
              "/base.yaml\ndata_use: tuning\n"
              "axes:\n"
              "  every: {set: filters.every, values: {two: 2, three: 3}}\n"
              "  solver: {values: {near: {set: {solvers.distance_m: 0.1}}, far: {}}}\n"
              "data: {plain: {seeds: 4-5, seed_setting: source.frames}, other: {}}\n"
              "comparisons:\n"
              "  - {axis: every, metric: counts.solved}\n"
              "  - {axis: solver, reference: near, metric: counts.solved}\n"
              "expect:\n"
              "  - {where: {solver: near}, metric: counts.solved, at_least: 0}\n"
              "  - {where: {data: plain}, metric: counts.solved, at_least: 0}\n",
          "parent.yaml");
  }

  std::string write_child(const std::string& rest) const {
    return write("weft: 1\nname: child\nextends: parent.yaml\n" + rest, "child.yaml");
  }

  Grid load(const std::string& file, const Texts& settings = {}, const Texts& without = {}) const {
    auto [grid, report] = load_grid(file, registry_, settings, {}, without);
    EXPECT_TRUE(report.ok()) << report.text();
    return std::move(grid);
  }

  std::string mistakes(const std::string& file, const Texts& settings,
                       const Texts& without = {}) const {
    return load_grid(file, registry_, settings, {}, without).second.text();
  }

  static Texts keys(const Grid& grid) {
    Texts keys;
    for (const Cell& cell : grid.cells()) keys.push_back(cell.identity.key);
    return keys;
  }

  static Texts axes(const Grid& grid) {
    Texts names;
    for (const Axis& axis : grid.plan().axes) names.push_back(axis.name);
    return names;
  }

  static Texts values(const Grid& grid, std::size_t axis) {
    Texts names;
    for (const NamedPatch& value : grid.plan().axes.at(axis).values) names.push_back(value.name);
    return names;
  }
};

TEST_F(PlanExtends, HasTheCellsOfTheExtendedPlanUnderAnotherName) {
  const Grid parent = load(path("parent.yaml")), child = load(write_child(""));
  EXPECT_EQ(child.plan().name, "child");
  ASSERT_EQ(parent.cells().size(), 2U * 2U * 3U);
  EXPECT_EQ(keys(child), keys(parent));
}

TEST_F(PlanExtends, ReadsRelativePathsInTheFolderOfTheFileThatSaysThem) {
  std::filesystem::create_directories(path("set/a"));
  std::ofstream(path("set/a/camera.yaml")) << "fx: 1\n";
  std::filesystem::create_directories(path("below"));
  write("weft: 1\nname: p\npipeline: " WEFT_PLANS
        "/base.yaml\ndata_use: tuning\ndata: {recorded: {folders: set/*}}\n",
        "recorded.yaml");
  const auto [plan, report] =
      read_plan(write("weft: 1\nname: c\nextends: ../recorded.yaml\n", "below/c.yaml"), registry_,
                {.frames_source = "sources/images", .picture_sink = {}});
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(plan.data.front().sequences.front().name, "a");
}

TEST_F(PlanExtends, AddsValuesAndPutsANewAxisBeforeTheOneListedAfterIt) {
  const Grid child =
      load(write_child("axes:\n  match: {set: detectors.count, values: [30]}\n  every: {}\n"
                       "  solver: {values: {farther: {set: {solvers.distance_m: 0.5}}}}\n"));
  EXPECT_THAT(axes(child), ElementsAre("match", "every", "solver"));
  EXPECT_THAT(values(child, 2), ElementsAre("near", "far", "farther"));
}

TEST_F(PlanExtends, TakesOtherValuesWithAnotherSetting) {
  const Grid child =
      load(write_child("axes: {every: {set: detectors.count, values: {some: 50}}}\n"));
  EXPECT_THAT(values(child, 0), ElementsAre("some"));
}

TEST_F(PlanExtends, LeavesOutAxesValuesAndDataWithWhatIsAboutThem) {
  const Grid child = load(write_child("without: [every, solver.near, data.plain]\n"));
  EXPECT_THAT(axes(child), ElementsAre("solver"));
  EXPECT_THAT(values(child, 0), ElementsAre("far"));
  EXPECT_EQ(child.cells().size(), 1U);
  EXPECT_TRUE(child.plan().comparisons.empty());
  EXPECT_TRUE(child.plan().expect.empty());
}

TEST_F(PlanExtends, IsTheSameFromTheCommandLineAsFromAFile) {
  const Grid file =
      load(write_child("without: [solver]\naxes: {every: {values: {two: 4}}}\n"
                       "data: {plain: {seeds: 6-7, set: {filters.no_result_at: [1]}}}\n"));
  const Grid line = load(path("parent.yaml"),
                         {"axes.every.values.two=4", "data.plain.seeds=6-7",
                          "data.plain.set.filters.no_result_at=[1]"},
                         {"solver"});
  EXPECT_EQ(keys(line), keys(file));
}

TEST_F(PlanExtends, TakesSettingsOfThePlanAndOfItsPipelinesTogether) {
  const Grid grid = load(path("parent.yaml"), {"solvers.distance_m=0.7", "seeds=3-5"}, {"solver"});
  EXPECT_EQ(grid.cells().size(), 2U * 3U * 3U);
  EXPECT_THAT(grid.settings(), ElementsAre("solvers.distance_m=0.7"));
}

TEST_F(PlanExtends, SaysWhichNameOfASettingDoesNotExist) {
  const std::string file = path("parent.yaml");
  EXPECT_THAT(mistakes(file, {"axes.evry.values=[1]"}),
              HasSubstr("--set axes.evry.values=[1], column 6: the plan has no axis 'evry'; "
                        "did you mean 'every'?"));
  EXPECT_THAT(mistakes(file, {"axes.every.values.tow=1"}),
              HasSubstr("column 19: the plan has no value 'tow'; did you mean 'two'?"));
  EXPECT_THAT(mistakes(file, {"axes.every.valeus=[1]"}),
              HasSubstr("column 12: an axis has no key 'valeus'; did you mean 'values'?"));
  EXPECT_THAT(mistakes(file, {"data.plane.seeds=1"}),
              HasSubstr("column 6: the plan has no data 'plane'; did you mean 'plain'?"));
  EXPECT_THAT(mistakes(file, {"axes.=1"}), HasSubstr("column 6: expected a name"));
  EXPECT_THAT(mistakes(file, {"seeds=[1"}), HasSubstr("--set seeds=[1, column "));
  EXPECT_THAT(mistakes(file, {}, {"solver.ner"}),
              HasSubstr("--without solver.ner, column 1: the axis 'solver' has no value 'ner'; "
                        "did you mean 'near'?"));
}

TEST_F(PlanExtends, NamesTheFileThatHasTheMistake) {
  write("weft: 1\nname: broken\nextends: parent.yaml\naxes: {every: {valeus: {}}}\n",
        "broken.yaml");
  const std::string child = write("weft: 1\nname: child\nextends: broken.yaml\n", "child.yaml");
  EXPECT_THAT(mistakes(child, {}), HasSubstr("broken.yaml:4:16: an axis has no key 'valeus'"));
}

TEST_F(PlanExtends, RefusesACircleOfPlansWhereItCloses) {
  write("weft: 1\nname: a\nextends: b.yaml\n", "a.yaml");
  write("weft: 1\nname: b\nextends: a.yaml\n", "b.yaml");
  const std::string text = mistakes(path("a.yaml"), {});
  EXPECT_THAT(text, HasSubstr("b.yaml:3:10: 'extends': "));
  EXPECT_THAT(text, HasSubstr("a.yaml extends itself"));
}

}  // namespace
}  // namespace weft::lab
