// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using testing::chain;
using ::testing::ElementsAre;
using testing::head;
using testing::lines;
using ::testing::StartsWith;

class ComponentChecks : public testing::PipelineTest {
 protected:
  std::vector<std::string> mistakes(const std::string& text) const {
    return lines(check(text).second);
  }
};

TEST_F(ComponentChecks, PlaceEachMistakeAtTheValueThatItIsAbout) {
  EXPECT_THAT(mistakes("weft: 1\n"
                       "source:\n"
                       "  use: sources/test.scripted\n"
                       "  params: {frames: 2, doubt: 'of this', note: odd}\n"
                       "template: {use: templates/test.scripted}\n"),
              ElementsAre("4:30: of this", "4:47: 'note' is odd"));
}

TEST_F(ComponentChecks, PlaceAMistakeAboutNoParameterAtTheComponent) {
  EXPECT_THAT(mistakes(head("{note: nameless}")), ElementsAre("2:15: everything is odd"));
}

TEST_F(ComponentChecks, ReachNestedComponents) {
  EXPECT_THAT(
      mistakes(head() +
               "stages:\n"
               "  - use: solvers/test.holder\n"
               "    params: {initial_guess: {use: solvers/test.scripted, params: {doubt: so}}}\n"),
      ::testing::Contains("6:74: so"));
}

TEST_F(ComponentChecks, AreInOnePassWithAllOtherMistakes) {
  EXPECT_THAT(mistakes("weft: 1\n"
                       "seed: -1\n"
                       "source: {use: sources/test.scripted, params: {doubt: so}}\n"
                       "template: {use: templates/test.scripted, params: {columns: 1}}\n"
                       "stages:\n"
                       "  - {use: warps/test.absent}\n"),
              ElementsAre(StartsWith("2:7: 'seed' must be"), "3:54: so",
                          StartsWith("4:60: 'columns' is 1"), StartsWith("6:11: no plugin")));
}

TEST_F(ComponentChecks, PlaceASettingsMistakeInIt) {
  const auto [pipeline, report] =
      check_pipeline(write(head()), registry_, path("run"), {"source.doubt=so"});
  EXPECT_EQ(report.text(), "--set source.doubt=so, column 14: so\n");
}

TEST_F(ComponentChecks, ReportAnExceptionAsAMistakeOfTheComponent) {
  EXPECT_THAT(mistakes(head("{doubt: throw}")),
              ElementsAre("2:15: sources/test.scripted: threw: scripted exception"));
}

TEST_F(ComponentChecks, LeaveOutComponentsWithIllegalParametersAndIsolatedStages) {
  EXPECT_THAT(mistakes(head("{doubt: so, frames: -1}")),
              ElementsAre(StartsWith("2:66: 'frames' is -1")));
  const std::string isolated =
      "stages:\n  - {use: matchers/test.pattern}\n"
      "  - {use: warps/test.scripted}\n"
      "  - {use: passes/test.scripted}\n"
      "  - {use: solvers/test.scripted, isolate: process, params: {doubt: so}}\n";
  EXPECT_TRUE(check(head() + isolated).second.ok());
}

TEST_F(ComponentChecks, AskTheSameComponentWithTheSameValuesOnce) {
  const std::string file = write("", "lines.txt");
  const auto text_with = [&](int frames) {
    return head("{path: '" + file +
                "', note: \"add a line to 'path'\", frames: " + std::to_string(frames) + "}");
  };
  host::ComponentChecks checks;
  for (const int frames : {1, 2, 1, 1, 2}) {
    const std::string pipeline = write(text_with(frames));
    const auto paths = host::PathRules::of_process({}, path("run"));
    const auto checked = check_pipeline(pipeline, read_document(pipeline, {}, registry_, paths),
                                        registry_, path("run"), &checks);
    EXPECT_TRUE(checked.second.ok()) << checked.second.text();
  }
  EXPECT_EQ(testing::read_lines(file).size(), 2U);
}

TEST_F(ComponentChecks, AreNotNeededByComponentsThatHaveNothingToSay) {
  EXPECT_TRUE(check(chain()).second.ok());
}

}  // namespace
}  // namespace weft
