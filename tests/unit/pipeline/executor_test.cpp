// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "host/records/record.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using testing::chain;
using ::testing::Each;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using testing::head;
using testing::Ran;
using ::testing::StartsWith;

class Execution : public testing::PipelineTest {
 protected:
  /// The latest value of a slot in a frame.
  template <class RecordType>
  static std::optional<RecordType> value(const Ran& ran, std::size_t frame,
                                         const std::string& type) {
    std::optional<RecordType> found;
    if (frame >= ran.frames.size()) return found;
    for (const host::RecordPtr& record : ran.frames[frame].values) {
      if (record == nullptr || record->type() != type) continue;
      if (auto typed = host::view_as<RecordType>(*record)) found = *std::move(typed);
    }
    return found;
  }
};

TEST_F(Execution, RecoversThePlaneOfTheScene) {
  const Ran ran = run(chain());
  ASSERT_TRUE(ran.summary) << ran.summary.error().message;
  EXPECT_EQ(ran.announced, 3);
  EXPECT_EQ(ran.states(), "estimated estimated estimated");
  EXPECT_EQ(ran.summary->failed, 0);
  const auto shape = value<Shape>(ran, 0, Shape::kType);
  ASSERT_TRUE(shape);
  // Texel (u, v) of the scripted scene lies at ((u / 2 + 20 - 79.5) / 500, ..., 0.2) m.
  EXPECT_NEAR(shape->vertices_m(29, 0), (50.0 + 20.0 - 79.5) / 500.0, 1e-12);
  EXPECT_NEAR(shape->vertices_m(29, 1), (40.0 + 20.0 - 59.5) / 500.0, 1e-12);
  EXPECT_NEAR(shape->vertices_m(29, 2), 0.2, 1e-12);
  EXPECT_EQ(ran.frames[1].stem, "f1");
}

TEST_F(Execution, SkipsWithTheFirstCauseDownToTheSinks) {
  const Ran ran = run(chain({{"matchers", "{no_result_at: [1], error_at: [2]}"}}, "max_failed: 1"));
  const std::string none = "skipped: matchers: scripted no result";
  for (const char* stage : {"filters", "warps", "passes", "solvers"}) {
    EXPECT_EQ(ran.status(1, stage), none) << stage;
    EXPECT_EQ(ran.status(2, stage), "skipped: matchers: matchers/test.scripted: scripted error");
  }
  EXPECT_EQ(ran.status(1, "detectors"), "ok");
  EXPECT_EQ(ran.states(), "estimated predicted/1 predicted/2");
  EXPECT_FALSE(ran.frames[1].failed());
  EXPECT_TRUE(ran.frames[2].failed());
  const Ran strict = run(head() +
                             "stages:\n"
                             "  - {use: matchers/test.pattern}\n"
                             "  - {use: warps/test.scripted, params: {error_at: [0]}}\n"
                             "  - {use: passes/test.scripted}\n"
                             "sinks:\n"
                             "  - {use: sinks/test.visibility}\n",
                         "strict");
  EXPECT_EQ(strict.status(0, "sinks"), "skipped: warps: warps/test.scripted: scripted error");
  EXPECT_EQ(strict.status(1, "sinks"), "ok");
}

TEST_F(Execution, RefusesAPassThatLeavesOutWhatItProduces) {
  const Ran ran = run(chain({{"passes", "{silent_at: [1]}"}}));
  const std::string cause = "passes/test.scripted: did not produce its output 'sightlines'";
  EXPECT_EQ(ran.status(1, "passes"), "error: " + cause);
  EXPECT_EQ(ran.status(1, "solvers"), "skipped: passes: " + cause);
}

TEST_F(Execution, GoesOnAfterErrorsAndExceptionsOfSingleFrames) {
  const Ran ran = run(chain({{"sources", "{frames: 6, error_at: [4]}"},
                             {"detectors", "{throw_at: [1]}"},
                             {"warps", "{error_at: [2]}"},
                             {"sinks", "{error_at: [3]}"}}));
  ASSERT_TRUE(ran.summary);
  EXPECT_EQ(ran.summary->frames, 6);
  EXPECT_EQ(ran.summary->failed, 4);
  EXPECT_FALSE(ran.summary->stopped);
  EXPECT_EQ(ran.status(1, "detectors"),
            "error: detectors/test.scripted: threw: scripted exception");
  EXPECT_EQ(ran.status(2, "warps"), "error: warps/test.scripted: scripted error");
  EXPECT_EQ(ran.status(3, "sinks"), "error: sinks/test.scripted: scripted error");
  EXPECT_EQ(ran.status(4, "sources"), "error: sources/test.scripted: scripted error");
  EXPECT_EQ(ran.states(), "estimated predicted/1 predicted/2 estimated predicted/1 estimated");
}

TEST_F(Execution, SkipsAllStagesOfAFrameThatTheSourceCannotRead) {
  for (const char* key : {"error_at", "no_result_at", "throw_at", "nan_at"}) {
    const Ran ran = run(chain({{"sources", "{" + std::string(key) + ": [1]}"}}), key);
    ASSERT_TRUE(ran.summary);
    for (const char* stage : {"detectors", "matchers", "filters", "warps", "passes", "solvers"}) {
      EXPECT_THAT(ran.status(1, stage), StartsWith("skipped: sources: ")) << key;
    }
    EXPECT_EQ(ran.states(), "estimated predicted/1 estimated") << key;
    EXPECT_EQ(ran.frames[1].failed(), key != std::string("no_result_at")) << key;
    EXPECT_EQ(ran.status(1, "sinks"), "ok") << key;
  }
}

TEST_F(Execution, CombinesTheMasksOfAllFilters) {
  const Ran ran = run(head("{frames: 1}") +
                      "stages:\n"
                      "  - {use: matchers/test.pattern, params: {count: 24}, as: all}\n"
                      "  - {use: filters/test.scripted, params: {every: 2}}\n"
                      "  - {use: filters/test.scripted, params: {every: 3}}\n"
                      "  - {use: filters/test.scripted, from: {correspondences: all}}\n");
  EXPECT_EQ(ran.number(0, "all", "kept"), 24);
  EXPECT_EQ(ran.number(0, "filters", "kept"), 12);
  EXPECT_EQ(ran.number(0, "filters#2", "diag.kept_before"), 12);
  EXPECT_EQ(ran.number(0, "filters#2", "kept"), 8);  // neither a multiple of 2 nor of 3
  EXPECT_EQ(ran.number(0, "filters#2", "matches"), 24);
  EXPECT_EQ(ran.number(0, "filters#3", "kept"), 24);  // chose the matches before any filter
  EXPECT_EQ(ran.number(0, "filters#3", "diag.kept_before"), 24);
}

TEST_F(Execution, LeavesMatchesWhereTheyAreAndTakesTheLastScores) {
  const Ran ran = run(head("{frames: 1}") +
                      "stages:\n"
                      "  - {use: matchers/test.pattern, params: {count: 5}}\n"
                      "  - {use: filters/test.scripted, params: {every: 2}}\n");
  const auto matches = value<Correspondences>(ran, 0, Correspondences::kType);
  ASSERT_TRUE(matches && matches->count() == 5);
  for (std::int64_t i = 0; i < 5; ++i) {
    EXPECT_EQ(matches->kept(i), i % 2);
    EXPECT_EQ(matches->score(i), static_cast<double>(i));
    EXPECT_DOUBLE_EQ(matches->image_px(i, 0), 0.5 * matches->template_px(i, 0) + 20.0);
  }
}

TEST_F(Execution, UsesDegenerateResultsAndCountsThemSeparately) {
  for (const char* role : {"detectors", "matchers", "filters", "warps", "passes", "solvers"}) {
    const Ran ran = run(chain({{role, "{degenerate_at: [1]}"}}), role);
    EXPECT_EQ(ran.states(), "estimated estimated estimated") << role;
    EXPECT_EQ(ran.status(1, role), "degenerate: scripted degeneracy");
    EXPECT_EQ(ran.summary->failed, 0);
  }
}

TEST_F(Execution, RefusesResultsThatDoNotFitByName) {
  const std::vector<std::array<std::string, 3>> cases = {
      {"detectors", "wrong_length_at", "returned an illegal output: keypoints/1: array 'response'"},
      {"detectors", "nan_at", "keypoints/1: array 'xy_px' holds NaN or infinity"},
      {"filters", "wrong_length_at",
       "inlier_mask/1 has 25 entries for 24 of the input 'correspondences'"},
      {"filters", "nan_at", "inlier_mask/1: array 'score' holds NaN"},
      {"warps", "short_samples_at", "warp_samples/1 has 29 entries for 30 of the input 'points'"},
      {"passes", "wrong_length_at", "visibility/1 has 31 entries for 30 of the input 'template'"},
      {"passes", "bad_vertex_at",
       "the vertex of sightline 29 has the index 30, the template has 30"},
      {"passes", "nan_at", "sightlines/1: array 'ray' holds NaN"},
      {"solvers", "wrong_length_at", "shape/1 has 31 entries for 30 of the input 'template'"},
      {"solvers", "bad_state_at", "a solver may set only estimated or weak"},
      {"solvers", "nan_at", "shape/1: array 'vertices_m' holds NaN"}};
  for (const auto& [role, key, message] : cases) {
    SCOPED_TRACE(role + " " + key);
    const Ran ran = run(chain({{role, "{" + key + ": [1]}"}}), role + key);
    ASSERT_TRUE(ran.summary);
    EXPECT_THAT(ran.status(1, role), StartsWith("error: " + role + "/test.scripted: "));
    EXPECT_THAT(ran.status(1, role), HasSubstr(message));
    EXPECT_EQ(ran.states(), "estimated predicted/1 estimated");
    EXPECT_EQ(ran.summary->failed, 1);
  }
}

TEST_F(Execution, RefusesMatchesOnFacesThatDoNotExist) {
  const Ran ran = run(head("{frames: 1}") +
                      "stages:\n"
                      "  - {use: matchers/test.pattern, params: {bad_face: true}}\n");
  EXPECT_THAT(ran.status(0, "matchers"),
              EndsWith("the face of match 0 has the index 1000000, the template has 40"));
}

TEST_F(Execution, GivesMatchesOfWhichAMatcherSaysThePlaceTheirFaces) {
  const auto run_of = [&](const std::string& params, const std::string& out) {
    const std::string stage = "  - {use: matchers/test.pattern, params: " + params + "}\n";
    return run(head("{frames: 1}") + "stages:\n" + stage, out);
  };
  const Ran with = run_of("{}", "with"), without = run_of("{places_only: true}", "without");
  const auto said = value<Correspondences>(with, 0, Correspondences::kType).value();
  const auto found = value<Correspondences>(without, 0, Correspondences::kType).value();
  ASSERT_EQ(found.count(), 24);
  for (std::int64_t n = 0; n < found.count(); ++n) {
    EXPECT_GE(found.face(n), 0);
    EXPECT_EQ(found.face(n), said.face(n));
    for (int k = 0; k < 3; ++k) EXPECT_EQ(found.barycentrics(n, k), said.barycentrics(n, k));
  }
}

TEST_F(Execution, RefusesFramesThatDoNotFitTheCameraOrTheTemplate) {
  const Ran size = run(chain({{"sources", "{wrong_size_at: [1]}"}}), "size");
  EXPECT_EQ(size.status(1, "sources"),
            "error: sources/test.scripted: the image has 200x120 px, the camera 160x120 px");
  EXPECT_EQ(size.states(), "estimated predicted/1 estimated");
  const Ran vertex =
      run(head("{known_vertex: 30}") + "stages:\n  - {use: solvers/test.known}\n", "vertex");
  EXPECT_THAT(vertex.status(0, "sources"), EndsWith("has the index 30, the template has 30"));
  const Ran legal =
      run(head("{known_vertex: 29}") + "stages:\n  - {use: solvers/test.known}\n", "legal");
  EXPECT_EQ(legal.states(), "estimated estimated estimated");
}

TEST_F(Execution, RecordsAWarpThatHasNoSamplesAsNoResult) {
  const Ran ran = run(chain({{"warps", "{evaluate_no_result_at: [1]}"}}));
  EXPECT_EQ(ran.status(1, "warps"), "no_result: scripted no samples");
  EXPECT_EQ(ran.summary->failed, 0);
}

TEST_F(Execution, ReportsCountsAndEvidence) {
  const Ran ran = run(chain({{"filters", "{every: 4}"}}));
  EXPECT_EQ(ran.number(0, "detectors", "keypoints"), 24);
  EXPECT_EQ(ran.number(0, "matchers", "matches"), 24);
  EXPECT_EQ(ran.number(0, "filters", "kept"), 18);
  EXPECT_EQ(ran.number(0, "passes", "sightlines"), 30);
  EXPECT_TRUE(std::isfinite(ran.number(0, "solvers", "diag.draw")));
}

TEST_F(Execution, RunsEachDetectorOnTheTemplateWithItsOwnParameters) {
  const auto text = [](const std::string& more) {
    return head("{frames: 1}") + "stages:\n  - use: detectors/test.scripted\n" +
           "    params: {count: 24}\n" + more + "  - {use: matchers/test.scripted}\n";
  };
  EXPECT_EQ(run(text(""), "same").number(0, "matchers", "matches"), 24);
  EXPECT_EQ(run(text("    template_params: {count: 9}\n"), "own").number(0, "matchers", "matches"),
            9);
}

TEST_F(Execution, GivesTwoMatchersTheKeypointsOfTheirDetectors) {
  const Ran ran = run(head("{frames: 1}") +
                      "stages:\n"
                      "  - {use: detectors/test.scripted, as: coarse, params: {count: 6}}\n"
                      "  - {use: matchers/test.scripted, as: first}\n"
                      "  - {use: detectors/test.scripted, as: fine, params: {count: 18}}\n"
                      "  - {use: matchers/test.scripted, as: second}\n"
                      "  - {use: matchers/test.merge, from: {correspondences: [first, second]}}\n"
                      "  - {use: filters/test.scripted, params: {every: 2}}\n");
  EXPECT_EQ(ran.number(0, "first", "matches"), 6);
  EXPECT_EQ(ran.number(0, "second", "matches"), 18);
  EXPECT_EQ(ran.number(0, "matchers", "matches"), 24);
  EXPECT_EQ(ran.number(0, "filters", "kept"), 12);
}

TEST_F(Execution, RunsNestedComponentsAndReportsTheirTime) {
  const Ran ran = run(head("{frames: 2}") +
                      "stages:\n"
                      "  - {use: matchers/test.pattern}\n"
                      "  - use: filters/test.warped\n"
                      "    params: {warp: {use: warps/test.scripted, params: {error_at: [1]}}}\n"
                      "  - {use: warps/test.scripted}\n"
                      "  - {use: passes/test.scripted}\n"
                      "  - {use: solvers/test.holder, params: {initial_guess: {use: "
                      "solvers/test.scripted}}}\n");
  EXPECT_EQ(ran.states(), "estimated predicted/1");
  EXPECT_EQ(ran.status(1, "filters"), "error: warps/test.scripted: scripted error");
  std::set<std::string> timed;
  for (const host::Timing& timing : ran.frames[0].timings) timed.insert(timing.component);
  EXPECT_THAT(timed, ::testing::IsSupersetOf({"sources", "filters", "filters/warp", "warps",
                                              "solvers", "solvers/initial_guess"}));
}

TEST_F(Execution, GivesTruthToComponentsThatUseIt) {
  const Ran ran = run(head("{truth: true}") +
                      "stages:\n  - {use: matchers/test.pattern}\n  - {use: filters/test.truth}\n");
  EXPECT_EQ(ran.number(0, "filters", "diag.truths"), 1);
  const Ran without =
      run(head() + "stages:\n  - {use: matchers/test.pattern}\n  - {use: filters/test.truth}\n",
          "without");
  EXPECT_EQ(without.status(0, "filters"), "skipped: sources: no ground_truth");
}

TEST_F(Execution, DrawsTheSameForAStageNameWhateverPrecedesIt) {
  const auto text = [](const std::string& filters) {
    return head("{frames: 2}") + "stages:\n  - {use: matchers/test.pattern}\n" + filters +
           "  - {use: warps/test.scripted}\n  - {use: passes/test.scripted}\n"
           "  - {use: solvers/test.scripted}\n";
  };
  const Ran one = run(text(""), "one");
  const Ran two = run(text("  - {use: filters/test.scripted}\n"), "two");
  const Ran other = run("seed: 1\n" + text(""), "other");
  EXPECT_EQ(one.number(0, "solvers", "diag.draw"), two.number(0, "solvers", "diag.draw"));
  EXPECT_NE(one.number(0, "solvers", "diag.draw"), one.number(1, "solvers", "diag.draw"));
  EXPECT_NE(one.number(0, "solvers", "diag.draw"), other.number(0, "solvers", "diag.draw"));
}

}  // namespace
}  // namespace weft
