// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>

#include "lab/ablation/plan/grid.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::lab {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::StartsWith;

const Helpers kHelpers{.frames_source = "sources/images", .picture_sink = {}};

/// Plans with errors. Their first comments are the expected messages, a line for each error:
/// `# line:column: beginning of the message`. The name of another file comes before it if the error
/// is not in the plan.
std::vector<std::string> wrong_plans() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(WEFT_PLANS)) {
    const std::string name = entry.path().stem().string();
    if (entry.is_regular_file() && name != "base") names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// The errors of a plan as the program prints them, without folders.
std::vector<std::string> mistakes(const std::string& file, const host::Registry& registry) {
  auto [plan, report] = load_plan(file, registry, {}, kHelpers);
  if (report.ok()) report = Grid::expand(std::move(plan), registry, {}).second;
  std::vector<std::string> lines;
  for (const yaml::Problem& problem : report.problems) {
    const std::string place = place_in(report.sources, problem.at);
    lines.push_back(fs::path(place).filename().string() + ": " + problem.message);
  }
  return lines;
}

class WrongPlan : public weft::testing::PipelineTest,
                  public ::testing::WithParamInterface<std::string> {};

TEST_P(WrongPlan, IsAnsweredWithEveryMistakeAndItsPlace) {
  const std::string file = std::string(WEFT_PLANS) + "/" + GetParam() + ".yaml";
  std::vector<std::string> expected;
  for (const std::string& line : weft::testing::read_lines(file)) {
    if (!line.starts_with("# ")) break;
    const bool elsewhere = line.find(".yaml:") != std::string::npos;
    expected.push_back((elsewhere ? "" : GetParam() + ".yaml:") + line.substr(2));
  }
  ASSERT_FALSE(expected.empty()) << "the file says nothing of its mistakes";
  const std::vector<std::string> found = mistakes(file, registry_);
  EXPECT_EQ(found.size(), expected.size()) << ::testing::PrintToString(found);
  for (std::size_t i = 0; i < std::min(found.size(), expected.size()); ++i) {
    EXPECT_THAT(found[i], StartsWith(expected[i]));
  }
}

INSTANTIATE_TEST_SUITE_P(Files, WrongPlan, ::testing::ValuesIn(wrong_plans()),
                         [](const auto& test) { return test.param; });

class PlanTest : public weft::testing::PipelineTest {
 protected:
  /// A plan over the base of the folder of plans.
  std::string write_plan(const std::string& rest) const {
    return write("weft: 1\nname: plan\npipeline: " + std::string(WEFT_PLANS) +
                     "/base.yaml\ndata_use: tuning\n" + rest,
                 "plan.yaml");
  }

  Grid expand(const std::string& rest, std::vector<std::string> settings = {}) const {
    auto [plan, report] = read_plan(write_plan(rest), registry_);
    EXPECT_TRUE(report.ok()) << report.text();
    auto [grid, mistakes] = Grid::expand(std::move(plan), registry_, std::move(settings));
    EXPECT_TRUE(mistakes.ok()) << mistakes.text();
    return std::move(grid);
  }

  /// A parameter of a component of a cell's pipeline, as the effective configuration has it.
  static std::string parameter(const StageConfig& stage, const std::string& name) {
    return stage.component.effective.find("params")->find(name)->scalar;
  }
};

TEST_F(PlanTest, MakesACellOfEachCombinationInTheOrderOfTheFile) {
  const Grid grid = expand(
      "axes:\n  every: {set: filters.every, values: [2, 3]}\n"
      "  solver: {values: {near: {set: {solvers.distance_m: 0.1}}, far: {}}}\n"
      "data: {plain: {seeds: [4, 6-7], seed_setting: source.frames}, other: {}}\nseeds: 1-2\n");
  ASSERT_EQ(grid.cells().size(), 2U * 2U * 4U * 2U);
  std::vector<std::string> first;
  for (std::size_t i = 0; i < 10; ++i) {
    const Cell& cell = grid.cells()[i];
    first.push_back(grid.value_of(cell, "every") + grid.value_of(cell, "solver") + " " +
                    grid.value_of(cell, "sequence") + " " + grid.value_of(cell, "seed"));
  }
  EXPECT_THAT(
      first, ElementsAre("2near plain_4 1", "2near plain_4 2", "2near plain_6 1", "2near plain_6 2",
                         "2near plain_7 1", "2near plain_7 2", "2near other 1", "2near other 2",
                         "2far plain_4 1", "2far plain_4 2"));
}

TEST_F(PlanTest, LaysDataThenAxesThenTheCommandLineOverThePipeline) {
  const Grid grid = expand(
      "axes:\n  every: {set: filters.every, values: {two: 2}}\n"
      "data: {plain: {set: {filters.every: 7, filters.no_result_at: [1], source.frames: 9}}}\n",
      {"source.frames=5"});
  const auto [pipeline, report] = grid.load(grid.cells().front());
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(parameter(*pipeline.config.source, "frames"), "5");
  EXPECT_EQ(parameter(pipeline.config.stages[2], "every"), "2");
  const yaml::Node& params = *pipeline.config.stages[2].component.effective.find("params");
  EXPECT_EQ(params.find("no_result_at")->items.size(), 1U);
}

TEST_F(PlanTest, LeavesStagesOutAndPutsOthersIn) {
  const Grid grid = expand(
      "axes:\n  filter:\n    values:\n      none: {without: [filters]}\n"
      "      twice: {stages: [{use: filters/test.scripted}, {use: filters/test.random, as: "
      "late}]}\n"
      "data: {plain: {}}\n");
  EXPECT_THAT(grid.cells()[0].stages,
              ElementsAre("detectors", "matchers", "warps", "passes", "solvers"));
  EXPECT_THAT(grid.cells()[1].stages, ElementsAre("detectors", "matchers", "filters", "late",
                                                  "warps", "passes", "solvers"));
}

TEST_F(PlanTest, DrawsSamplesOfSurfacesWhereItNamesSuchAMetric) {
  const auto samples = [&](const std::string& show) {
    return expand("data: {plain: {}}\nshow: [" + show + "]\n")
        .plan()
        .measurement.options.surface_samples;
  };
  EXPECT_EQ(samples("surface.chamfer_mm"), 0);
  EXPECT_EQ(samples("surface.sampled_chamfer_mm"), kSurfaceSamples);
  EXPECT_EQ(samples("parts.hidden.surface.sampled_from_truth_mm"), kSurfaceSamples);
}

TEST_F(PlanTest, TakesAFolderForASequence) {
  for (const char* name : {"b", "a"}) {
    fs::create_directories(path(std::string("set/") + name + "/gt"));
    std::ofstream(path(std::string("set/") + name + "/camera.yaml")) << "fx: 1\n";
  }
  const auto [plan, report] =
      read_plan(write_plan("data: {recorded: {folders: set/*}}\n"), registry_, kHelpers);
  ASSERT_TRUE(report.ok()) << report.text();
  ASSERT_EQ(plan.data.front().sequences.size(), 2U);
  EXPECT_EQ(plan.data.front().sequences[0].name, "a");
  const yaml::Node& set = *plan.data.front().sequences[0].patch.find("set");
  EXPECT_EQ(set.find("source.path")->scalar, path("set/a/frames/*.png"));
  EXPECT_EQ(set.find("source.truth")->scalar, path("set/a/gt/*.npz"));
}

TEST_F(PlanTest, NamesTheCellWhereAPatchBreaksAnotherFile) {
  const std::vector<std::string> found =
      mistakes(std::string(WEFT_PLANS) + "/wiring.yaml", registry_);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found[0], ::testing::EndsWith("\n    in the cell pass=none, sequence=all"));
}

}  // namespace
}  // namespace weft::lab
