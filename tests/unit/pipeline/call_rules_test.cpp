// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "host/records/record.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using testing::chain;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::head;
using testing::lines;
using testing::Ran;
using ::testing::StartsWith;

/// Stages that are called in some frames only.
class CallRules : public testing::PipelineTest {
 protected:
  /// A cheap matcher, one that replaces it by the rule `when`, and a component that unites them.
  static std::string with_fallback(const std::string& cheap_params, const std::string& when) {
    return head("{frames: 6}") +
           "stages:\n"
           "  - {use: matchers/test.pattern, as: cheap, params: " +
           cheap_params +
           "}\n"
           "  - {use: detectors/test.scripted, when: " +
           when +
           "}\n"
           "  - {use: matchers/test.scripted, as: costly}\n"
           "  - {use: matchers/test.merge, from: {correspondences: [cheap, costly]}}\n"
           "  - {use: warps/test.scripted}\n"
           "  - {use: passes/test.scripted}\n"
           "  - {use: solvers/test.scripted}\n";
  }

  /// "1101": in which frames a stage was called.
  static std::string called(const Ran& ran, const std::string& stage) {
    std::string text;
    for (std::size_t i = 0; i < ran.frames.size(); ++i) {
      text += ran.report(i, stage).status == StageStatus::skipped ? '0' : '1';
    }
    return text;
  }

  std::vector<std::string> mistakes(const std::string& when) const {
    return lines(check(head() +
                       "stages:\n"
                       "  - {use: matchers/test.pattern, as: cheap}\n"
                       "  - {use: filters/test.scripted, when: " +
                       when +
                       "}\n"
                       "  - {use: filters/test.scripted, as: later}\n"
                       "sinks:\n"
                       "  - {use: sinks/test.scripted, as: shown}\n")
                     .second);
  }
};

TEST_F(CallRules, AStageIsCalledWhereAnotherOneIsNotOk) {
  for (const char* key : {"no_result_at", "error_at", "degenerate_at"}) {
    const Ran ran =
        run(with_fallback("{" + std::string(key) + ": [1, 4]}", "{not_ok: cheap}"), key);
    EXPECT_EQ(called(ran, "detectors"), "010010") << key;
    EXPECT_EQ(called(ran, "costly"), "010010") << key;
    EXPECT_EQ(ran.status(0, "detectors"), "skipped: not called: 'cheap' is ok");
    EXPECT_EQ(ran.status(0, "costly"), "skipped: detectors: not called: 'cheap' is ok");
    EXPECT_EQ(ran.number(0, "matchers", "matches"), 24) << "of the cheap one alone";
    EXPECT_EQ(ran.states(), "estimated estimated estimated estimated estimated estimated") << key;
  }
}

TEST_F(CallRules, ASkippedStageIsNotOk) {
  const Ran ran = run(head("{frames: 3, error_at: [1]}") +
                      "stages:\n"
                      "  - {use: detectors/test.scripted}\n"
                      "  - {use: matchers/test.scripted, as: cheap}\n"
                      "  - {use: matchers/test.pattern, as: costly, when: {not_ok: cheap}}\n");
  EXPECT_THAT(ran.status(1, "cheap"), StartsWith("skipped: sources: "));
  EXPECT_EQ(called(ran, "costly"), "010");
}

TEST_F(CallRules, AStageIsCalledEverySoManyFramesOrWhereOneOfSeveralIsNotOk) {
  EXPECT_EQ(called(run(with_fallback("{}", "{every: 4}"), "every"), "detectors"), "100010");
  EXPECT_EQ(called(run(with_fallback("{}", "{every: 1}"), "each"), "detectors"), "111111");
  const Ran both = run(with_fallback("{no_result_at: [2]}", "{every: 4, not_ok: cheap}"), "both");
  EXPECT_EQ(called(both, "detectors"), "101010");
  EXPECT_EQ(both.status(1, "detectors"),
            "skipped: not called: 'cheap' is ok, and it is called every 4 frames");
  const Ran several = run(head("{frames: 3}") +
                              "stages:\n"
                              "  - {use: matchers/test.pattern, as: a, params: {error_at: [0]}}\n"
                              "  - {use: matchers/test.pattern, as: b, params: {error_at: [2]}}\n"
                              "  - {use: matchers/test.pattern, when: {not_ok: [a, b]}}\n",
                          "several");
  EXPECT_EQ(called(several, "matchers"), "101");
  EXPECT_EQ(several.status(1, "matchers"), "skipped: not called: 'a' is ok, 'b' is ok");
}

TEST_F(CallRules, AreListedInTheEffectiveConfigurationAndMayBeSet) {
  const std::string text = with_fallback("{}", "{not_ok: [cheap], every: 4}");
  const auto [config, report] = load(text);
  ASSERT_TRUE(report.ok()) << report.text();
  const std::string effective = effective_yaml(config);
  const auto [again, second] = load(effective);
  ASSERT_TRUE(second.ok()) << second.text();
  EXPECT_EQ(effective_yaml(again), effective);
  ASSERT_TRUE(again.stages[1].when);
  EXPECT_EQ(again.stages[1].when->every, 4);
  EXPECT_EQ(again.stages[1].when->not_ok.front().name, "cheap");
  const auto [set, third] =
      load_pipeline(write(text), registry_, path("run"), {"detectors.when.every=7"});
  ASSERT_TRUE(third.ok()) << third.text();
  EXPECT_EQ(set.stages[1].when->every, 7);
  EXPECT_EQ(set.stages[1].when->not_ok.size(), 1U) << "maps are merged";
}

TEST_F(CallRules, AreRefusedWhereTheySayNothingOrNameNoEarlierStage) {
  EXPECT_THAT(mistakes("{not_ok: cheep}"),
              ElementsAre("6:49: no earlier stage is named 'cheep'; did you mean 'cheap'?"));
  EXPECT_THAT(mistakes("{not_ok: later}"),
              ElementsAre("6:49: 'later' comes later; move it up, before 'filters'"));
  EXPECT_THAT(mistakes("{not_ok: [cheap, filters]}"),
              ElementsAre("6:57: 'filters' cannot wait for itself"));
  EXPECT_THAT(mistakes("{not_ok: shown}"),
              ElementsAre("6:49: 'shown' is a sink, which makes nothing to be read"));
  EXPECT_THAT(mistakes("{not_ok: sources}"),
              ElementsAre("6:49: no earlier stage is named 'sources'"));
  EXPECT_THAT(mistakes("{}"), ElementsAre(HasSubstr("'when' is empty")));
  EXPECT_THAT(mistakes("cheap"), ElementsAre(StartsWith("6:40: 'when' must be a map, such as")));
  EXPECT_THAT(mistakes("{every: 0}"),
              ElementsAre("6:48: 'every' must be a whole number from 1 to 2147483647"));
  EXPECT_THAT(mistakes("{not_ok: []}"),
              ElementsAre("6:49: 'not_ok' must be the name of a stage, or a list of names"));
  EXPECT_THAT(mistakes("{weak: cheap}"), ElementsAre(StartsWith("6:41: 'when' has no key 'weak'")));
}

TEST_F(CallRules, SinksHaveNone) {
  const auto report = check(chain() + "").second;
  EXPECT_TRUE(report.ok()) << report.text();
  const auto refused = check(head() + "sinks:\n  - {use: sinks/test.scripted, when: {every: 2}}\n");
  EXPECT_THAT(refused.second.text(), HasSubstr("a sink has no key 'when'"));
}

TEST_F(CallRules, AStageThatDecidesWhetherAnotherIsCalledIsNotUnread) {
  const std::string text = chain();
  const auto with = [&](const std::string& when) {
    std::string whole = text;
    return whole
        .insert(whole.find("  - {use: detectors"), "  - {use: matchers/test.pattern, as: probe}\n")
        .insert(whole.find("detectors/test.scripted, ") + 25, when);
  };
  EXPECT_THAT(check(with("")).second.text(), HasSubstr("no component reads the correspondences"));
  EXPECT_EQ(check(with("when: {not_ok: probe}, ")).second.text(), "");
}

TEST_F(CallRules, GiveTheSameBytesAgain) {
  const std::string text = with_fallback("{no_result_at: [1, 4]}", "{not_ok: cheap, every: 3}");
  const Ran one = run(text, "one"), two = run(text, "two");
  for (const char* frame : {"000000", "000001", "000002", "000004"}) {
    const std::string file = "/frames/" + std::string(frame) + ".npz";
    EXPECT_EQ(testing::read_text(one.folder + file), testing::read_text(two.folder + file));
  }
}

TEST_F(CallRules, EarlierImagesOfTheSourceMayBeRead) {
  const Ran ran = run(head("{frames: 3}") +
                      "stages:\n"
                      "  - {use: detectors/test.scripted, from: {image: previous.image}}\n"
                      "  - {use: detectors/test.scripted, as: farther, from: {image: "
                      "previous.image@2}}\n");
  EXPECT_EQ(ran.status(0, "detectors"), "skipped: previous.image: none 1 frames ago");
  EXPECT_EQ(called(ran, "detectors"), "011");
  EXPECT_EQ(called(ran, "farther"), "001");
}

}  // namespace
}  // namespace weft
