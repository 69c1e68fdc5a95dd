// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <weft/data/matrix.hpp>

#include "host/records/record.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using testing::chain;
using ::testing::Each;
using ::testing::HasSubstr;
using testing::head;
using testing::Ran;

class States : public testing::PipelineTest {
 protected:
  static Shape shape(const Ran& ran, std::size_t frame) {
    return *host::view_as<Shape>(*ran.frames.at(frame).shape);
  }
};

TEST_F(States, EmitsNothingBeforeTheFirstShape) {
  const Ran ran = run(chain({{"solvers", "{no_result_at: [0, 1]}"}}));
  EXPECT_EQ(ran.states(), "none none estimated");
  EXPECT_EQ(ran.frames[1].shape, nullptr);
  EXPECT_EQ(ran.summary->failed, 0);
  EXPECT_EQ(ran.status(0, "solvers"), "no_result: scripted no result");
}

TEST_F(States, PredictsThenLosesThenRecovers) {
  const Ran ran = run(chain(
      {{"sources", "{frames: 9}"}, {"solvers", "{no_result_at: [1, 2, 3, 4, 6], weak_at: [8]}"}},
      "lost_after: 2"));
  EXPECT_EQ(ran.states(),
            "estimated predicted/1 predicted/2 lost/3 lost/4 estimated predicted/1 estimated weak");
}

TEST_F(States, LosesTheShapeAtOnceWhenLostAfterIsZero) {
  const Ran ran = run(chain({{"solvers", "{no_result_at: [1]}"}}, "lost_after: 0"));
  EXPECT_EQ(ran.states(), "estimated lost/1 estimated");
}

TEST_F(States, RepeatsTheVerticesOfAPredictedShape) {
  const Ran ran = run(chain({{"solvers", "{no_result_at: [1, 2]}"}}));
  const Shape measured = shape(ran, 0), predicted = shape(ran, 2);
  EXPECT_EQ(predicted.shape_state(), ShapeState::predicted);
  EXPECT_TRUE(measured.vertices_m.matrix<3>() == predicted.vertices_m.matrix<3>());
}

TEST_F(States, GivesBackPredictedAndLostShapesAsPrevious) {
  const Ran ran = run(chain({{"sources", "{frames: 5}"}, {"solvers", "{error_at: [1, 2, 3]}"}},
                            "lost_after: 2\nmax_failed: 3"));
  EXPECT_EQ(ran.states(), "estimated predicted/1 predicted/2 lost/3 estimated");
  const auto previous = [&](std::size_t frame) {
    return std::pair(ran.number(frame, "filters", "diag.previous_state"),
                     ran.number(frame, "filters", "diag.previous_age"));
  };
  EXPECT_EQ(previous(0), std::pair(0.0, -1.0));
  EXPECT_EQ(previous(1), std::pair(1.0, 0.0));
  EXPECT_EQ(previous(2), std::pair(3.0, 1.0));
  EXPECT_EQ(previous(3), std::pair(3.0, 2.0));
  EXPECT_EQ(previous(4), std::pair(4.0, 3.0));
  EXPECT_EQ(ran.number(4, "solvers", "diag.previous_state"), 4.0);
}

TEST_F(States, FeedsBackTheLastVisibilityThatWasProduced) {
  const Ran ran = run(head("{frames: 4}") +
                      "stages:\n"
                      "  - {use: passes/test.memory}\n"
                      "  - {use: matchers/test.pattern}\n"
                      "  - {use: warps/test.scripted}\n"
                      "  - {use: passes/test.scripted, params: {no_result_at: [0, 2]}}\n"
                      "  - {use: solvers/test.scripted}\n");
  const auto fed = [&](std::size_t frame) {
    return std::pair(ran.number(frame, "passes", "diag.previous_visibility"),
                     ran.number(frame, "passes", "diag.previous_state"));
  };
  EXPECT_EQ(fed(0), std::pair(0.0, 0.0));
  EXPECT_EQ(fed(1), std::pair(1.0, 0.0));  // its own, of frame 0
  EXPECT_EQ(fed(2), std::pair(1.0, 1.0));
  EXPECT_EQ(fed(3), std::pair(1.0, 3.0));
}

TEST_F(States, UnorderedFramesHaveNothingOfTheFrameBefore) {
  const std::map<std::string, std::string> scripted{{"sources", "{frames: 4}"},
                                                    {"solvers", "{no_result_at: [2]}"}};
  const Ran film = run(chain(scripted));
  const Ran unordered = run(chain(scripted, "sequence: false"), "unordered");
  EXPECT_EQ(film.states(), "estimated estimated predicted/1 estimated");
  EXPECT_EQ(unordered.states(), "estimated estimated none estimated");
  for (std::size_t frame = 0; frame < 4; ++frame) {
    EXPECT_EQ(film.number(frame, "filters", "diag.previous_state") > 0.0, frame > 0);
    EXPECT_EQ(unordered.number(frame, "filters", "diag.previous_state"), 0.0);
  }
  EXPECT_THAT(testing::read_text(unordered.folder + "/pipeline.yaml"),
              HasSubstr("sequence: false"));
  EXPECT_THAT(testing::read_text(unordered.folder + "/manifest.json"),
              HasSubstr("\"sequence\": false"));
}

TEST_F(States, TakesTheLastShapeOfTwoSolversAndTheFirstWhereTheLastFails) {
  const Ran ran = run(head("{frames: 3}") +
                      "stages:\n"
                      "  - {use: matchers/test.pattern}\n"
                      "  - {use: warps/test.scripted}\n"
                      "  - {use: passes/test.scripted}\n"
                      "  - {use: solvers/test.scripted, params: {distance_m: 0.5}}\n"
                      "  - {use: solvers/test.scripted, params: {no_result_at: [1]}}\n"
                      "sinks:\n"
                      "  - {use: sinks/test.scripted, params: {path: lines.txt}}\n");
  EXPECT_EQ(ran.states(), "estimated estimated estimated");
  EXPECT_DOUBLE_EQ(shape(ran, 0).vertices_m(0, 2), 0.2);
  EXPECT_DOUBLE_EQ(shape(ran, 1).vertices_m(0, 2), 0.5);
  EXPECT_DOUBLE_EQ(shape(ran, 2).vertices_m(0, 2), 0.2);
  EXPECT_THAT(testing::read_lines(ran.folder + "/lines.txt"), Each(HasSubstr("estimated 24")));
}

TEST_F(States, GivesTheShapeOfTheGivenNumberOfFramesAgo) {
  const std::string text = chain({{"sources", "{frames: 6}"}, {"solvers", "{no_result_at: [2]}"}});
  const std::string filter = "  - {use: filters/test.scripted, params: {}";
  std::string late = text;
  late.replace(late.find(filter), filter.size(),
               filter + ", from: {previous.shape: previous.shape@2}");
  const Ran ran = run(late);
  const auto age = [&](std::size_t frame) {
    return ran.number(frame, "filters", "diag.previous_age");
  };
  EXPECT_EQ(ran.states(), "estimated estimated predicted/1 estimated estimated estimated");
  EXPECT_EQ(age(0), -1);
  EXPECT_EQ(age(1), -1);
  EXPECT_EQ(age(2), 0);
  EXPECT_EQ(age(3), 0);
  EXPECT_EQ(age(4), 1);  // frame 2 was predicted
  EXPECT_EQ(age(5), 0);
}

TEST_F(States, SkipsAStageWhoseRequiredInputIsNotYetFedBack) {
  const Ran ran = run(head("{frames: 3}") +
                      "stages:\n"
                      "  - {use: matchers/test.pattern}\n"
                      "  - {use: filters/test.scripted, from: {correspondences: "
                      "previous.correspondences@2}}\n");
  EXPECT_EQ(ran.status(0, "filters"), "skipped: previous.correspondences: none 2 frames ago");
  EXPECT_EQ(ran.status(1, "filters"), "skipped: previous.correspondences: none 2 frames ago");
  EXPECT_EQ(ran.status(2, "filters"), "ok");
}

}  // namespace
}  // namespace weft
