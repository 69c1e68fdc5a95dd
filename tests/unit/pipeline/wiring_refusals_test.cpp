// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::head;
using ::testing::IsEmpty;
using testing::lines;

class WiringRefusals : public testing::PipelineTest {};

TEST_F(WiringRefusals, SaysWhatANamedStageMakesInstead) {
  const auto refusal = [&](const std::string& stages) {
    const auto found = lines(check(head() + "stages:\n" + stages).second);
    return found.size() == 1 ? found[0] : std::to_string(found.size()) + " mistakes";
  };
  const std::string grid = "  - {use: detectors/test.scripted, as: grid}\n";
  const std::string taking = "  - {use: filters/test.scripted, from: {correspondences: ";
  EXPECT_EQ(refusal(grid + "  - {use: matchers/test.scripted}\n" + taking + "grid}}\n"),
            "7:41: 'grid' makes keypoints, template_keypoints, not 'correspondences'; that is made "
            "by: matchers");
  EXPECT_EQ(refusal(taking + "grid}}\n" + grid),
            "5:41: 'grid' makes keypoints, template_keypoints, not 'correspondences'");
  EXPECT_EQ(refusal(taking + "sources}}\n"),
            "5:41: 'sources' makes image, time, known_points, ground_truth, camera, not "
            "'correspondences'");
  EXPECT_THAT(refusal(taking + "filters}}\n"), HasSubstr("'filters' cannot read what it makes"));
  EXPECT_EQ(refusal(taking + "lines}}\nsinks:\n  - {use: sinks/test.scripted, as: lines}\n"),
            "5:41: 'lines' is a sink, which makes nothing to be read");
}

TEST_F(WiringRefusals, RefusesWhatUnorderedFramesDoNotHave) {
  const std::string stages =
      "stages:\n"
      "  - {use: matchers/test.pattern}\n"
      "  - {use: filters/test.scripted, from: {previous.shape: previous.shape@2}}\n"
      "  - {use: warps/test.scripted}\n"
      "  - {use: passes/test.scripted}\n"
      "  - {use: solvers/test.scripted}\n";
  EXPECT_THAT(lines(check(head() + stages).second), IsEmpty());
  EXPECT_THAT(lines(check("sequence: false\n" + head() + stages).second),
              ElementsAre(HasSubstr("'previous.shape@2' cannot be read: with 'sequence: false' no "
                                    "frame has one before it")));
  EXPECT_THAT(lines(check("sequence: maybe\n" + head()).second),
              ElementsAre("1:11: 'sequence' must be true or false"));
}

TEST_F(WiringRefusals, LetsAMatcherThatReadsMoreThanMatchesHaveTheLatestOrNone) {
  const auto refusals = [&](const std::string& stages) {
    return lines(check(head() + "stages:\n" + stages).second);
  };
  const std::string matcher = "  - {use: matchers/test.pattern}\n";
  EXPECT_THAT(refusals("  - {use: matchers/test.beside}\n"), IsEmpty());
  EXPECT_THAT(refusals(matcher + "  - {use: matchers/test.beside}\n"), IsEmpty());
  EXPECT_THAT(refusals(matcher + matcher +
                       "  - {use: matchers/test.beside, from: {correspondences: [matchers, "
                       "matchers#2]}}\n"),
              IsEmpty());
}

TEST_F(WiringRefusals, RefusesAMergerThatIsGivenOnlyTheLatest) {
  const auto refusals = [&](const std::string& stages) {
    return lines(check(head() + "stages:\n" + stages).second);
  };
  const std::string matcher = "  - {use: matchers/test.pattern}\n";
  EXPECT_THAT(refusals("  - {use: matchers/test.merge}\n"),
              ElementsAre("5:5: matchers/test.merge unites several 'correspondences', but there is "
                          "none; leave it out"));
  EXPECT_THAT(refusals(matcher + "  - {use: matchers/test.merge}\n"),
              ElementsAre(HasSubstr("but there is one; leave it out")));
  EXPECT_THAT(refusals(matcher + matcher + "  - {use: matchers/test.merge}\n"),
              ElementsAre("7:5: matchers/test.merge unites several 'correspondences', and without "
                          "'from' it is given the latest only; choose from: {correspondences: "
                          "[matchers, matchers#2]}"));
  EXPECT_THAT(refusals(matcher + matcher +
                       "  - {use: matchers/test.merge, from: {correspondences: [matchers, "
                       "matchers#2]}}\n"),
              IsEmpty());
  EXPECT_THAT(
      refusals(matcher + "  - {use: matchers/test.merge, from: {correspondences: matchers}}\n"),
      IsEmpty());
  EXPECT_THAT(refusals(matcher + "  - {use: matchers/test.merge, from: 3}\n"),
              ElementsAre(HasSubstr("'from' must be a map")));
}

/// From matches to a shape, with stages before the warp, behind the solver, and sinks.
std::string solved(const std::string& before, const std::string& behind = "",
                   const std::string& sinks = "") {
  return head() + "stages:\n" + before +
         "  - {use: warps/test.scripted}\n"
         "  - {use: passes/test.scripted}\n"
         "  - {use: solvers/test.scripted}\n" +
         behind + (sinks.empty() ? "" : "sinks:\n" + sinks);
}
constexpr const char* kMatcher = "  - {use: matchers/test.pattern}\n";
constexpr const char* kSink = "  - {use: sinks/test.scripted}\n";

TEST_F(WiringRefusals, RefusesAStageWhoseMatchesAnotherReplaces) {
  EXPECT_THAT(
      lines(check(solved(std::string(kMatcher) + kMatcher)).second),
      ElementsAre("5:5: no component reads the correspondences of 'matchers', because 'matchers#2' "
                  "makes new ones; name it with as: NAME and take what it makes with from: "
                  "{correspondences: NAME}, or leave it out: --set without=matchers"));
  EXPECT_THAT(
      lines(check(solved("  - {use: detectors/test.scripted, as: a}\n"
                         "  - {use: detectors/test.scripted, as: b}\n"
                         "  - {use: matchers/test.scripted}\n"))
                .second),
      ElementsAre("5:5: no component reads the keypoints of 'a', because 'b' makes new ones; take "
                  "what it makes with from: {keypoints: a}, or leave it out: --set without=a"));
  // No component reads the keypoints either once those matches are gone.
  EXPECT_THAT(lines(check(solved("  - {use: detectors/test.scripted, as: a}\n"
                                 "  - {use: matchers/test.scripted, as: first}\n" +
                                 std::string(kMatcher)))
                        .second),
              ElementsAre(HasSubstr("or omit all unused ones: --set without=a,first")));
}

TEST_F(WiringRefusals, RefusesAStageThatComesTooLate) {
  const auto refusals = [&](const std::string& behind, const std::string& sinks = "") {
    return lines(check(solved(kMatcher, behind, sinks)).second);
  };
  EXPECT_THAT(
      refusals("  - {use: warps/test.scripted}\n"),
      ElementsAre("9:5: no component reads the warp_samples of 'warps#2', which comes after "
                  "'passes'; move it up, before 'passes', or leave it out: --set without=warps#2"));
  EXPECT_THAT(
      refusals("  - {use: passes/test.scripted}\n"),
      ElementsAre(
          "9:5: no component reads the sightlines of 'passes#2', which comes after 'solvers'; move "
          "it up, before 'solvers', or leave it out: --set without=passes#2"));
  const std::string filter = "  - {use: filters/test.scripted, as: again}\n";
  const std::string late =
      "9:5: no component reads the correspondences of 'again', which comes after 'warps'; move it "
      "up, before 'warps', or leave it out: --set without=again";
  EXPECT_THAT(refusals(filter), ElementsAre(late));
  // A sink that reads the latest matches would show others than those of the shape.
  EXPECT_THAT(
      refusals(filter, kSink),
      ElementsAre("9:5: only sinks read the correspondences of 'again', which comes after 'warps'; "
                  "move it up, before 'warps', or leave it out: --set without=again; a sink that "
                  "shows it needs from: {correspondences: again}"));
  EXPECT_THAT(refusals(filter, "  - {use: sinks/test.scripted, from: {correspondences: again}}\n"),
              IsEmpty());
}

TEST_F(WiringRefusals, TakesStagesWhoseWorkIsReadInOtherWays) {
  // A sink reads the first, and the next frame reads the second. The third gives the shape of
  // frames in which the other solver has none.
  const std::string pass = "  - {use: passes/test.scripted}\n";
  EXPECT_TRUE(check(solved(kMatcher, pass, "  - {use: sinks/test.visibility}\n")).second.ok());
  EXPECT_TRUE(
      check(solved("  - {use: passes/test.memory}\n" + std::string(kMatcher), pass)).second.ok());
  EXPECT_TRUE(check(solved(kMatcher, "  - {use: solvers/test.scripted}\n")).second.ok());
  // Unordered images have no next frame: the visibility is the run folder's.
  EXPECT_FALSE(check(solved(kMatcher, pass)).second.ok());
  EXPECT_TRUE(check("sequence: false\n" + solved(kMatcher, pass)).second.ok());
  EXPECT_TRUE(
      check(head() + "stages:\n" + kMatcher + "  - {use: solvers/test.known}\nsinks:\n" + kSink)
          .second.ok());
  // Without a solver stages are there to be measured.
  EXPECT_TRUE(check(head() + "stages:\n" + kMatcher + kMatcher + "  - {use: warps/test.scripted}\n")
                  .second.ok());
}

TEST_F(WiringRefusals, ReportsUnreadStagesOnlyWhereNothingElseIsWrong) {
  EXPECT_THAT(lines(check(solved(std::string(kMatcher) +
                                 "  - {use: matchers/test.pattern, from: {keypoint: a}}\n"))
                        .second),
              ElementsAre(HasSubstr("does not read 'keypoint'")));
  EXPECT_THAT(
      lines(check(solved(std::string(kMatcher) +
                         "  - {use: matchers/test.pattern, params: {cuont: 1}}\n"))
                .second),
      ElementsAre(HasSubstr("5:5: no component reads"), HasSubstr("did you mean 'count'?")));
}

}  // namespace
}  // namespace weft
