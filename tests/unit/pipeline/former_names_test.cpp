// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// The solver test.holder has `initial_guess`, which was `start`.
class FormerNames : public testing::PipelineTest {
 protected:
  static std::string holder(const std::string& params) {
    return "weft: 1\n"
           "source: {use: sources/test.scripted}\n"
           "template: {use: templates/test.scripted}\n"
           "stages:\n"
           "  - use: solvers/test.holder\n"
           "    params: " +
           params + "\n";
  }

  std::pair<PipelineConfig, ConfigReport> set(const std::string& setting) const {
    return load_pipeline(write(holder("{initial_guess: {use: solvers/test.scripted}}")), registry_,
                         path("run"), {setting});
  }

  /// A line for each, with its place.
  static std::string warnings_of(const ConfigReport& report) {
    std::string text;
    for (const auto& [at, message] : report.warnings) {
      text += place_in(report.sources, at) + ": " + message + "\n";
    }
    return text;
  }

  static std::string distance(const PipelineConfig& config) {
    const host::ComponentSpec& nested = config.stages.at(0).component.nested.at(0).component;
    return nested.effective.find("params")->find("distance_m")->scalar;
  }
};

TEST_F(FormerNames, AreWarnedOfAndReplaced) {
  const auto [config, report] =
      load(holder("{start: {use: solvers/test.scripted, params: {distance_m: 2}}}"));
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_THAT(warnings_of(report),
              HasSubstr("pipeline.yaml:6:14: 'start' (parameter of solvers/test.holder) is "
                        "deprecated: use 'initial_guess'; to update the file: weft migrate "));
  EXPECT_EQ(config.doubts.size(), 1U);
  EXPECT_EQ(distance(config), "2");
  EXPECT_THAT(effective_yaml(config), HasSubstr("initial_guess:"));
  EXPECT_THAT(effective_yaml(config), Not(HasSubstr("start:")));
}

TEST_F(FormerNames, OfParametersThatHaveNoOtherOneAreWarnedOfWithTheHelp) {
  const std::string expected =
      "pipeline.yaml:6:14: 'rounds' (parameter of solvers/test.holder) is deprecated: no effect: "
      "choose another initial_guess";
  const auto [config, report] = load(holder("{rounds: 3}"));
  ASSERT_TRUE(report.ok()) << report.text();
  ASSERT_EQ(config.doubts.size(), 1U);
  EXPECT_THAT(config.doubts[0], ::testing::EndsWith(expected));
  EXPECT_THAT(effective_yaml(config), HasSubstr("rounds: 3"));
  EXPECT_THAT(warnings_of(load(holder("{initial_guess: {}}")).second), IsEmpty());
}

TEST_F(FormerNames, CannotBeGivenBesideTheCurrentOne) {
  const auto report =
      load(holder("{initial_guess: {}, start: {use: solvers/test.scripted}}")).second;
  EXPECT_THAT(report.text(), HasSubstr("pipeline.yaml:6:33: 'start' is the former name of "
                                       "'initial_guess', which is given too"));
}

TEST_F(FormerNames, MayStandInSettings) {
  const auto [config, report] = set("solvers.start.distance_m=2");
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(distance(config), "2");
  EXPECT_THAT(warnings_of(report),
              HasSubstr("--set solvers.start.distance_m=2, column 9: 'start' (parameter of "
                        "solvers/test.holder) is deprecated: use 'initial_guess'\n"));
  EXPECT_THAT(warnings_of(set("solvers.initial_guess.distance_m=2").second), IsEmpty());
}

TEST_F(FormerNames, OverrideCurrentOnesOfAnExtendedFile) {
  write(holder("{initial_guess: {use: solvers/test.scripted, params: {distance_m: 2}}}"),
        "base.yaml");
  const auto [config, report] = load(
      "weft: 1\nextends: base.yaml\nstages:\n"
      "  - {as: solvers, params: {start: {params: {distance_m: 3}}}}\n");
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(distance(config), "3");
  EXPECT_THAT(warnings_of(report), HasSubstr("pipeline.yaml:4:28: 'start'"));
}

TEST_F(FormerNames, OfComponentsLeadToTheCurrentOne) {
  EXPECT_EQ(host::current_id("solvers/plain_start"), "solvers/initial_guess");
  EXPECT_EQ(host::current_id("solvers/test.holder"), "solvers/test.holder");
  EXPECT_EQ(host::current_parameter(registry_, "solvers/test.holder", "start"), "initial_guess");
  EXPECT_EQ(host::current_parameter(registry_, "solvers/test.absent", "start"), "start");
}

}  // namespace
}  // namespace weft
