// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "lab/ablation/plan/axis_sweep.hpp"
#include "lab/ablation/plan/grid.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::lab {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Texts = std::vector<std::string>;

/// Axes of components. Among the scripted filters, test.scripted declares the sweep of `every` over
/// 2, 3 and 5.
class PlanComponents : public weft::testing::PipelineTest {
 protected:
  std::string write_plan(const std::string& axes) const {
    return write("weft: 1\nname: plan\npipeline: " WEFT_PLANS
                 "/base.yaml\ndata_use: tuning\ndata: {all: {}}\naxes:\n" +
                     axes,
                 "plan.yaml");
  }

  Grid load(const std::string& axes, const Texts& without = {}) const {
    auto [grid, report] = load_grid(write_plan(axes), registry_, {}, {}, without);
    EXPECT_TRUE(report.ok()) << report.text();
    return std::move(grid);
  }

  std::string mistakes(const std::string& axes, const Texts& without = {}) const {
    return load_grid(write_plan(axes), registry_, {}, {}, without).second.text();
  }

  static Texts keys(const Grid& grid) {
    Texts keys;
    for (const Cell& cell : grid.cells()) keys.push_back(cell.identity.key);
    return keys;
  }

  static Texts values(const Grid& grid) {
    Texts names;
    for (const NamedPatch& value : grid.plan().axes.at(0).values) names.push_back(value.name);
    return names;
  }
};

TEST_F(PlanComponents, SweepsWhatTheComponentDeclaresInTheCellsOfAPlanByHand) {
  const Grid by_hand = load(
      "  filter:\n    values:\n"
      "      none: {without: [filters]}\n"
      "      a: {set: {filters.every: 2}}\n"
      "      b: {set: {filters.every: 3}}\n"
      "      c: {set: {filters.use: filters/test.scripted, filters.every: 5}}\n");
  const Grid declared = load(
      "  filter:\n    stage: filters\n    use: filters/test.s*\n    sweep: threshold\n"
      "    values: {none: {without: [filters]}}\n");
  EXPECT_THAT(values(declared),
              ElementsAre("none", "test.scripted_2", "test.scripted_3", "test.scripted_5"));
  EXPECT_EQ(keys(declared), keys(by_hand));
  const auto sweep = sweep_of(declared.plan().axes.front());
  ASSERT_TRUE(sweep);
  EXPECT_EQ(sweep->name, "filters.every");
}

TEST_F(PlanComponents, SweepsWhatAValueSays) {
  const Grid by_hand = load(
      "  filter: {values: {few_2: {set: {filters.error_at: [1], filters.every: 2}}, few_7: {set: "
      "{filters.error_at: [1], filters.every: 7}}}}\n");
  const Grid swept = load(
      "  filter: {values: {few: {set: {filters.error_at: [1]}, sweep: {filters.every: [2, "
      "7]}}}}\n");
  EXPECT_EQ(values(swept), values(by_hand));
  EXPECT_EQ(keys(swept), keys(by_hand));
}

TEST_F(PlanComponents, TakesEachComponentThatIsNotExcepted) {
  const std::string use = "  f: {stage: filters, use: [filters/test.random, filters/test.scripted]";
  EXPECT_THAT(values(load(use + "}\n")), ElementsAre("test.random", "test.scripted"));
  EXPECT_THAT(values(load(use + ", except: test.r*}\n")), ElementsAre("test.scripted"));
  EXPECT_THAT(values(load(use + ", except: [filters/test.scripted]}\n")),
              ElementsAre("test.random"));
  EXPECT_THAT(values(load(use + "}\n", {"f.test.random"})), ElementsAre("test.scripted"));
}

TEST_F(PlanComponents, GivesAComponentItsParameters) {
  const Grid by_hand = load("  f: {values: {a: {set: {filters.every: 4}}}}\n");
  const Grid given =
      load("  f: {stage: filters, use: filters/test.scripted, set: {test.scripted: {every: 4}}}\n");
  EXPECT_EQ(keys(given), keys(by_hand));
}

TEST_F(PlanComponents, SaysWhichWordMeansNothing) {
  const auto axis = [](const std::string& rest) { return "  f: {stage: filters, " + rest + "}\n"; };
  EXPECT_THAT(mistakes(axis("use: filtres/*")),
              HasSubstr("plan.yaml:7:28: no installed plugin is meant by 'filtres/*'; did you mean "
                        "'filters/*'?"));
  EXPECT_THAT(mistakes(axis("use: filters/test.scriptd")),
              HasSubstr("7:28: no plugin 'filters/test.scriptd' is installed; did you mean "
                        "'filters/test.scripted'?"));
  EXPECT_THAT(mistakes(axis("use: filters/test.s*, except: [test.scriptd]")),
              HasSubstr("7:54: there is no component in 'use' that is 'test.scriptd'; did you mean "
                        "'test.scripted'?"));
  EXPECT_THAT(mistakes(axis("use: filters/test.s*, except: [test.s*]")),
              HasSubstr("7:28: 'except' leaves nothing of 'use'"));
  EXPECT_THAT(mistakes(axis("use: filters/test.random, sweep: threshold")),
              HasSubstr("7:56: no threshold to sweep is declared by filters/test.random"));
  EXPECT_THAT(mistakes(axis("use: filters/test.random, sweep: every")),
              HasSubstr("7:56: 'sweep' beside 'use' must be threshold"));
  EXPECT_THAT(mistakes(axis("use: filters/test.random, set: {randm: {}}")),
              HasSubstr("7:55: there is no component in 'use' that is 'randm'"));
  EXPECT_THAT(mistakes(axis("use: filters/test.random, set: {test.random: 1}")),
              HasSubstr("'set' beside 'use' must be a map"));
  EXPECT_THAT(mistakes("  f: {use: filters/test.random}\n"),
              HasSubstr("7:6: an axis with 'use' lacks the key 'stage'"));
  EXPECT_THAT(mistakes("  f: {stage: filtres, use: filters/test.random}\n"),
              HasSubstr("7:14: no stage or sink is named 'filtres'; did you mean 'filters'?"));
  EXPECT_THAT(mistakes("  f: {values: {a: {sweep: threshold}}}\n"),
              HasSubstr("7:27: 'sweep' of a value must be one setting and its numbers"));
  EXPECT_THAT(mistakes(axis("use: filters/test.random"), {"f.test.randm"}),
              HasSubstr("--without f.test.randm, column 1: there is no component in 'use'"));
}

}  // namespace
}  // namespace weft::lab
