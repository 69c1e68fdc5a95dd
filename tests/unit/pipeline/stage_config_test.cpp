// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::head;
using testing::lines;
using ::testing::StartsWith;

class StageConfigs : public testing::PipelineTest {};

TEST_F(StageConfigs, NumbersStagesWithoutANameByRole) {
  const auto [config, report] = load(head() +
                                     "stages:\n"
                                     "  - {use: matchers/test.pattern}\n"
                                     "  - {use: filters/test.scripted}\n"
                                     "  - {use: filters/test.scripted, as: mine}\n"
                                     "  - {use: filters/test.scripted}\n");
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(config.stages[1].name, "filters");
  EXPECT_EQ(config.stages[2].name, "mine");
  EXPECT_EQ(config.stages[3].name, "filters#2");
  EXPECT_TRUE(config.stages[2].named);
  EXPECT_FALSE(config.stages[3].named);
}

TEST_F(StageConfigs, RefusesNamesThatAreIllegalTakenOrReserved) {
  const auto report = load(head() +
                           "stages:\n"
                           "  - {use: matchers/test.pattern, as: one}\n"
                           "  - {use: filters/test.scripted, as: one}\n"
                           "  - {use: filters/test.scripted, as: filters}\n"
                           "  - {use: filters/test.scripted, as: previous}\n"
                           "  - {use: filters/test.scripted, as: Zwei}\n"
                           "  - {use: filters/test.scripted, as: ''}\n"
                           "  - {use: filters/test.scripted, as: [a]}\n")
                          .second;
  EXPECT_THAT(lines(report),
              ElementsAre("6:38: the name 'one' is used twice",
                          "7:38: 'as' must not be 'filters', which is a reserved name",
                          "8:38: 'as' must not be 'previous', which is a reserved name",
                          "9:38: 'as' must be a name of a-z, 0-9 and _",
                          "10:38: 'as' must be a name of a-z, 0-9 and _",
                          "11:38: 'as' must be a name of a-z, 0-9 and _"));
}

TEST_F(StageConfigs, NamesSinksByTheSameRules) {
  const auto [config, report] = load(head() +
                                     "stages:\n"
                                     "  - {use: matchers/test.pattern}\n"
                                     "sinks:\n"
                                     "  - {use: sinks/test.scripted, as: lines}\n"
                                     "  - {use: sinks/test.scripted}\n"
                                     "  - {use: sinks/test.scripted}\n");
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(config.sinks[0].name, "lines");
  EXPECT_EQ(config.sinks[1].name, "sinks");
  EXPECT_EQ(config.sinks[2].name, "sinks#2");
  const auto refused = load(head() +
                            "stages:\n"
                            "  - {use: matchers/test.pattern, as: one}\n"
                            "sinks:\n"
                            "  - {use: sinks/test.scripted, as: one}\n"
                            "  - {use: sinks/test.scripted, as: sinks}\n")
                           .second;
  EXPECT_THAT(lines(refused),
              ElementsAre("7:36: the name 'one' is used twice",
                          "8:36: 'as' must not be 'sinks', which is a reserved name"));
}

TEST_F(StageConfigs, ReadsNamesAndListsOfNamesFromFrom) {
  const auto [config, report] = load(head() +
                                     "stages:\n"
                                     "  - {use: matchers/test.pattern, as: a}\n"
                                     "  - {use: matchers/test.pattern, as: b}\n"
                                     "  - {use: matchers/test.merge, from: {correspondences: [a, "
                                     "b]}}\n"
                                     "  - {use: filters/test.scripted, from: {correspondences: "
                                     "a}}\n");
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_THAT(config.stages[2].from[0].names, ElementsAre("a", "b"));
  EXPECT_THAT(config.stages[3].from[0].names, ElementsAre("a"));
}

TEST_F(StageConfigs, RefusesFromThatNamesNothing) {
  const auto report = load(head() +
                           "stages:\n"
                           "  - {use: matchers/test.merge, from: a}\n"
                           "  - {use: matchers/test.merge, from: {correspondences: []}}\n"
                           "  - {use: matchers/test.merge, from: {correspondences: }}\n"
                           "  - {use: matchers/test.merge, from: {correspondences: [{a: b}]}}\n")
                          .second;
  EXPECT_THAT(lines(report),
              ElementsAre(StartsWith("5:38: 'from' must be a map of inputs and names"),
                          "6:56: 'correspondences' must be the name of a stage, or a list of names",
                          HasSubstr("'correspondences' must be the name of a stage"),
                          HasSubstr("'correspondences' must be the name of a stage")));
}

TEST_F(StageConfigs, PutsTemplateParamsOverParams) {
  const auto [config, report] = load(head() +
                                     "stages:\n"
                                     "  - use: detectors/test.scripted\n"
                                     "    params: {count: 7, first_px: 3}\n"
                                     "    template_params: {count: 9}\n");
  ASSERT_TRUE(report.ok()) << report.text();
  const yaml::Node& image = *config.stages[0].component.effective.find("params");
  const yaml::Node& texture = *config.stages[0].on_template->effective.find("params");
  EXPECT_EQ(image.find("count")->scalar, "7");
  EXPECT_EQ(texture.find("count")->scalar, "9");
  EXPECT_EQ(texture.find("first_px")->scalar, "3");
}

TEST_F(StageConfigs, RefusesTemplateParamsThatCannotBe) {
  const auto report = load(head() +
                           "stages:\n"
                           "  - use: detectors/test.scripted\n"
                           "    params: {cout: 7}\n"
                           "    template_params: {coun: 9}\n"
                           "  - {use: detectors/test.scripted, template_params: 3}\n"
                           "  - {use: matchers/test.pattern, template_params: {}}\n")
                          .second;
  EXPECT_THAT(lines(report),
              ElementsAre(StartsWith("6:14: detectors/test.scripted has no parameter 'cout'"),
                          StartsWith("7:23: detectors/test.scripted has no parameter 'coun'"),
                          "8:53: template_params must be a map of names and values",
                          "9:51: only detectors have template_params"));
}

TEST_F(StageConfigs, AnIsolatedStageSaysSoInTheEffectiveConfiguration) {
  const auto [config, report] =
      load(head() +
           "stages:\n"
           "  - {use: matchers/test.pattern, isolate: process, deadline_ms: 250}\n"
           "  - {use: filters/test.scripted, isolate: process}\n"
           "  - {use: warps/test.scripted}\n");
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(config.stages[0].isolation->deadline.count(), 250);
  EXPECT_EQ(config.stages[1].isolation->deadline.count(), 0);
  EXPECT_FALSE(config.stages[2].isolation);
  const std::string text = effective_yaml(config);
  const auto [again, second] = load(text);
  ASSERT_TRUE(second.ok()) << second.text();
  EXPECT_EQ(effective_yaml(again), text);
  EXPECT_EQ(again.stages[0].isolation->deadline.count(), 250);
  EXPECT_TRUE(again.stages[1].isolation);
  EXPECT_FALSE(again.stages[2].isolation);
}

TEST_F(StageConfigs, IsolationIsRefusedWhereItMeansNothing) {
  const auto [config, report] =
      load(head() +
           "stages:\n"
           "  - {use: matchers/test.pattern, isolate: thread}\n"
           "  - {use: filters/test.scripted, deadline_ms: 250}\n"
           "  - {use: warps/test.scripted, isolate: process, deadline_ms: 0}\n"
           "sinks:\n"
           "  - {use: sinks/test.scripted, isolate: neither}\n");
  EXPECT_THAT(
      lines(report),
      ElementsAre("5:43: 'isolate' must be process, or none to run it in here",
                  "6:47: 'deadline_ms' needs 'isolate: process': only a process can be ended",
                  "7:63: 'deadline_ms' must be a whole number from 1 to 86400000",
                  "9:41: 'isolate' must be process, or none to run it in here"));
}

}  // namespace
}  // namespace weft
