// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <thread>

#include "support/embedded.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using testing::chain;
using ::testing::ElementsAre;
using testing::expect_same;
using ::testing::HasSubstr;
using testing::InMemory;
using testing::processed;
using testing::Ran;
using ::testing::StartsWith;

const Camera kCamera{100.0, 100.0, 79.5, 59.5, 160, 120};

class Embedding : public testing::PipelineTest {
 protected:
  static PipelineOptions with(std::vector<std::string> settings = {}) {
    return {
        .settings = std::move(settings), .plugin_path = {WEFT_TEST_PLUGINS}, .worker = WEFT_WORKER};
  }
  Result<Pipeline> load(const std::string& text, const PipelineOptions& options = with()) const {
    return Pipeline::load(write(text), kCamera, options);
  }
  /// A pipeline that must be sound.
  Pipeline opened(const std::string& text, const PipelineOptions& options = with()) const {
    auto loaded = load(text, options);
    if (!loaded) throw std::runtime_error(loaded.error().where + ": " + loaded.error().message);
    return *std::move(loaded);
  }
  static Image grey(std::int64_t height, std::int64_t width) {
    Image image;
    image.pixels = Array<std::uint8_t>({height, width}, 0);
    return image;
  }
  /// States of this number of grey images.
  static std::vector<ShapeState> states(Pipeline& pipeline, int frames) {
    std::vector<ShapeState> all;
    for (int i = 0; i < frames; ++i) {
      auto frame = pipeline.process(grey(120, 160), 0.04 * i);
      EXPECT_TRUE(frame) << frame.error().message;
      if (frame) all.push_back(frame->state());
    }
    return all;
  }
};

TEST_F(Embedding, GivesWhatARunOfTheSameImagesGives) {
  const std::string solvers = "{no_result_at: [0, 3], weak_at: [1], error_at: [6]}";
  const std::string text = chain({{"sources", "{frames: 8}"},
                                  {"filters", "{degenerate_at: [5]}"},
                                  {"solvers", solvers},
                                  {"sinks", "{path: lines.txt}"}},
                                 "seed: 7\nlost_after: 0");
  const Ran ran = run(text);
  ASSERT_TRUE(ran.summary) << ran.summary.error().message;
  EXPECT_EQ(ran.states(), "none weak estimated lost/1 estimated estimated lost/1 estimated");
  Pipeline pipeline = opened(text);
  expect_same(processed(pipeline, InMemory::of(path("pipeline.yaml"), registry_)), ran.folder);
}

TEST_F(Embedding, GivesTheSameWithAStageInAProcessOfItsOwn) {
  const std::string text = chain({{"sources", "{frames: 3}"}}, "frames_at_once: 3");
  const Ran ran = run(text);
  Pipeline pipeline = opened(text, with({"filters.isolate=process", "solvers.isolate=process"}));
  expect_same(processed(pipeline, InMemory::of(path("pipeline.yaml"), registry_)), ran.folder);
}

/// True if the check holds in a child of fork(), which is killed if it takes half a minute.
template <class Check>
bool holds_in_child(Check&& check) {
  const pid_t child = fork();
  if (child == 0) {
    alarm(30);
    _exit(check() ? 0 : 1);
  }
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST_F(Embedding, RefusesAtOnceInAForkedProcessAndLeavesTheParentsPipelineAlone) {
  const auto says_forked = [](const auto& answer) {
    return !answer && answer.error().code == Errc::unsupported &&
           answer.error().message.find("was forked") != std::string::npos;
  };
  for (const std::vector<std::string>& settings :
       {std::vector<std::string>{}, {"solvers.isolate=process"}}) {
    const std::string text = chain({{"sources", "{frames: 3}"}});
    std::optional<Pipeline> pipeline(opened(text, with(settings)));
    EXPECT_THAT(states(*pipeline, 1), ElementsAre(ShapeState::estimated));
    const Image image = grey(120, 160);
    EXPECT_TRUE(holds_in_child([&] { return says_forked(pipeline->process(image, 1.0)); }));
    EXPECT_TRUE(holds_in_child([&] { return says_forked(load(text, with(settings))); }));
    EXPECT_TRUE(holds_in_child([&] {
      Pipeline moved = std::move(*pipeline);
      pipeline.reset();
      return true;
    }));
    auto frame = pipeline->process(image, 1.0);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(frame->state(), ShapeState::estimated);
  }
}

TEST_F(Embedding, RefusesATimeThatGoesBackWithBothTimesAndTakesTheSameTimeAgain) {
  Pipeline pipeline = opened(chain({{"sources", "{frames: 3}"}}));
  ASSERT_TRUE(pipeline.process(grey(120, 160), 2.5));
  const auto back = pipeline.process(grey(120, 160), 2.25);
  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().where, "time");
  EXPECT_THAT(back.error().message, HasSubstr("2.25 s lies before"));
  EXPECT_THAT(back.error().message, HasSubstr("before, 2.5 s"));
  ASSERT_FALSE(pipeline.process(grey(120, 160), std::numeric_limits<double>::infinity()));
  const auto same = pipeline.process(grey(120, 160), 2.5);
  ASSERT_TRUE(same) << same.error().message;
  EXPECT_EQ(same->frame, 1U) << "what was refused counts for nothing";
  EXPECT_TRUE(pipeline.process(grey(120, 160), 2.5001));
}

TEST_F(Embedding, LooksAtNeitherSourceNorSinks) {
  const std::string stages =
      "template: {use: templates/test.scripted}\n"
      "stages:\n"
      "  - use: detectors/test.scripted\n  - use: matchers/test.scripted\n"
      "  - use: warps/test.scripted\n  - use: passes/test.scripted\n"
      "  - use: solvers/test.scripted\n";
  for (const std::string more : {"",
                                 "source: {use: sources/images, params: {path: not/there.png}}\n"
                                 "sinks: [{use: sinks/not_there, params: {path: /}}]\n"}) {
    Pipeline pipeline = opened("weft: 1\n" + more + stages);
    EXPECT_THAT(states(pipeline, 1), ElementsAre(ShapeState::estimated));
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1) << "it wrote";
}

TEST_F(Embedding, RefusesStagesThatWantMoreThanAnImage) {
  const auto refused = load(
      "weft: 1\ntemplate: {use: templates/test.scripted}\n"
      "source: {use: sources/test.scripted, params: {known_vertex: 0}}\n"
      "stages:\n  - use: solvers/test.known\n");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, path("pipeline.yaml") + ":5:5");
  EXPECT_EQ(refused.error().message,
            "solvers/test.known requires 'known_points', which no earlier stage produces and no "
            "program hands in");
}

TEST_F(Embedding, KeepsTheStatesOfTwoPipelinesSeparate) {
  Pipeline one = opened(chain({{"solvers", "{no_result_at: [0, 2]}"}}));
  Pipeline other = opened(chain({{"solvers", "{no_result_at: [1]}"}}));
  std::vector<ShapeState> of_one, of_other;
  for (int i = 0; i < 3; ++i) {
    of_one.push_back(one.process(grey(120, 160), i)->state());
    of_other.push_back(other.process(grey(120, 160), i)->state());
  }
  EXPECT_THAT(of_one, ElementsAre(ShapeState::none, ShapeState::estimated, ShapeState::predicted));
  EXPECT_THAT(of_other,
              ElementsAre(ShapeState::estimated, ShapeState::predicted, ShapeState::estimated));
}

TEST_F(Embedding, RunsPipelinesInThreadsOfTheirOwn) {
  const std::string text = chain({{"sources", "{frames: 20}"}}, "seed: 3");
  const Ran ran = run(text);
  const InMemory given = InMemory::of(path("pipeline.yaml"), registry_);
  std::vector<std::vector<ProcessedFrame>> frames(2);
  std::vector<std::thread> threads;
  for (std::vector<ProcessedFrame>& own : frames) {
    threads.emplace_back([&, pipeline = std::make_shared<Pipeline>(opened(text))] {
      own = processed(*pipeline, given);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& own : frames) expect_same(own, ran.folder);
}

TEST_F(Embedding, NamesThePlaceOfEachMistakeAndWhatWasMeant) {
  const auto refused = load(chain({{"filters", "{evry: 2}"}, {"solvers", "{distance_m: -1}"}}));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::invalid_value);
  EXPECT_THAT(refused.error().where, StartsWith(path("pipeline.yaml") + ":7:"));
  EXPECT_THAT(refused.error().message,
              StartsWith("filters/test.scripted has no parameter 'evry'; did you mean 'every'?\n" +
                         path("pipeline.yaml") + ":10:"));
  EXPECT_THAT(refused.error().message, HasSubstr("distance_m"));
}

TEST_F(Embedding, NamesASettingThatIsWrong) {
  const auto refused = load(chain(), with({"filters.every=-1"}));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().where, StartsWith("--set filters.every=-1, column"));
}

TEST_F(Embedding, SaysThatAFileIsNotThere) {
  const auto refused = Pipeline::load(path("nowhere.yaml"), kCamera, with());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, path("nowhere.yaml"));
  EXPECT_THAT(refused.error().message, HasSubstr("there is no such file"));
}

TEST_F(Embedding, RefusesACameraThatTakesNoPictures) {
  const Camera behind{-1.0, 100.0, 79.5, 59.5, 160, 120};
  const auto refused = Pipeline::load(write(chain()), behind, with());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, "camera");
  EXPECT_THAT(refused.error().message, StartsWith("the camera cannot be right: 'fx' is -1"));
}

TEST_F(Embedding, SaysWhatAStageSaysThatCannotStart) {
  const auto refused = load(chain({{"solvers", "{refuse: true}"}}));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "refuses as scripted");
  EXPECT_EQ(refused.error().where, "solvers/test.scripted");
}

TEST_F(Embedding, RefusesImagesThatAreNotOfTheCameraAndGoesOn) {
  Pipeline pipeline = opened(chain());
  Image absent;
  Image four = grey(120, 160);
  four.pixels = Array<std::uint8_t>({120, 160, 4}, 0);
  for (const Image& wrong : {absent, four, grey(120, 200)}) {
    const auto refused = pipeline.process(wrong, 0.0);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::invalid_data);
    EXPECT_EQ(refused.error().where, "image");
  }
  EXPECT_THAT(pipeline.process(four, 0.0).error().message, HasSubstr("[120,160,4]; give [H,W]"));
  EXPECT_THAT(pipeline.process(grey(120, 200), 0.0).error().message,
              HasSubstr("200x120 px, the camera 160x120 px"));
  const double never_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(pipeline.process(grey(120, 160), never_s).error().where, "time");
  const auto frame = pipeline.process(grey(120, 160), 0.0);
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(frame->frame, 0U);
  EXPECT_EQ(frame->state(), ShapeState::estimated);
}

TEST_F(Embedding, TellsStatesReasonsAndWarningsOfEachStage) {
  Pipeline pipeline =
      opened(chain({{"filters", "{degenerate_at: [0]}"}, {"solvers", "{error_at: [1]}"}}));
  const auto first = pipeline.process(grey(120, 160), 0.0);
  ASSERT_TRUE(first);
  EXPECT_FALSE(first->failed);
  EXPECT_GT(first->confidence(), 0.0);
  ASSERT_EQ(first->stages.size(), 6U);
  EXPECT_EQ(first->stages[2].name, "filters");
  EXPECT_EQ(first->stages[2].status, "degenerate");
  EXPECT_EQ(first->stages[2].reason, "scripted degeneracy");
  EXPECT_THAT(first->warnings, ElementsAre("filters: scripted warning"));
  const auto second = pipeline.process(grey(120, 160), 0.04);
  ASSERT_TRUE(second);
  EXPECT_TRUE(second->failed);
  EXPECT_EQ(second->frame, 1U);
  EXPECT_EQ(second->state(), ShapeState::predicted);
  EXPECT_EQ(second->confidence(), 0.0);
  EXPECT_EQ(second->stages[5].status, "error");
  EXPECT_THAT(second->stages[5].reason, HasSubstr("scripted error"));
  EXPECT_THAT(second->warnings, ElementsAre());
}

TEST_F(Embedding, GivesShapesThatOutliveIt) {
  std::optional<Shape> shape;
  {
    Pipeline pipeline = opened(chain());
    EXPECT_EQ(pipeline.templ().vertices_m.rows(), 30);
    Image image = grey(120, 160);
    shape = pipeline.process(image, 0.0)->shape;
    image.pixels(0, 0) = 9;  // it is the program's again
    Pipeline moved = std::move(pipeline);
    EXPECT_THAT(states(moved, 1), ElementsAre(ShapeState::estimated));
  }
  ASSERT_TRUE(shape);
  EXPECT_EQ(shape->vertices_m.rows(), 30);
  EXPECT_NEAR(shape->vertices_m(0, 2), 0.2, 1e-9);
  EXPECT_GE(shape->diag.value("draw", -1.0), 0.0);
}

/// Stages that need matches, which nothing in the file makes.
const std::string kOfMatches = testing::head() +
                               "stages:\n  - {use: filters/test.scripted}\n"
                               "  - {use: warps/test.scripted}\n  - {use: passes/test.scripted}\n"
                               "  - {use: solvers/test.scripted}\n";

TEST_F(Embedding, TakesMatchesInsteadOfAnImageIfTheyAreAnnounced) {
  EXPECT_THAT(load(kOfMatches).error().message, HasSubstr("no program hands in"));
  PipelineOptions options = with();
  options.inputs = {"correspondences"};
  Pipeline pipeline = opened(kOfMatches, options);
  FrameInputs inputs;
  inputs.correspondences = matches_between(pipeline.templ().flat_px, Array<double>({30, 2}, 50.0));
  const auto frame = pipeline.process(inputs, 0.0);
  ASSERT_TRUE(frame) << frame.error().where << ": " << frame.error().message;
  EXPECT_TRUE(frame->shape) << frame->report;
  EXPECT_THAT(frame->report, HasSubstr("\"kept\":30"));
  const auto without = pipeline.process(grey(120, 160), 0.1);
  ASSERT_TRUE(without) << without.error().message;
  EXPECT_EQ(without->stages[0].status, "skipped");
}

TEST_F(Embedding, RefusesInputsThatAreNotAnnouncedOrDoNotFitWithTheirNames) {
  PipelineOptions options = with();
  options.inputs = {"matches"};
  EXPECT_EQ(load(kOfMatches, options).error().where, "inputs");
  options.inputs = {"correspondences"};
  Pipeline pipeline = opened(kOfMatches, options);
  FrameInputs inputs;
  inputs.known_points = vertices_at(Array<std::int32_t>({1}, 0), Array<double>({1, 3}, 0.5));
  EXPECT_THAT(pipeline.process(inputs, 0.0).error().message,
              HasSubstr("add \"known_points\" to the inputs of its options"));
  const auto refused = [&](const Array<double>& image_px, const Array<double>& covariance_px2) {
    FrameInputs wrong;
    wrong.correspondences = matches_between(pipeline.templ().flat_px, image_px, covariance_px2);
    const auto frame = pipeline.process(wrong, 0.0);
    return frame ? "nothing" : frame.error().where;
  };
  EXPECT_EQ(refused(Array<double>({29, 2}, 50.0), {}), "correspondences");
  EXPECT_EQ(refused(Array<double>({30, 3}, 50.0), {}), "correspondences");
  EXPECT_EQ(refused(Array<double>({30, 2}, std::nan("")), {}), "correspondences");
  EXPECT_EQ(refused(Array<double>({30, 2}, 50.0), Array<double>({30, 2}, 1.0)), "correspondences");
}

TEST_F(Embedding, TakesRowsWithAStride) {
  Pipeline pipeline = opened(chain());
  const std::vector<std::uint8_t> camera_memory(120 * 192, 7);  // rows of 192 bytes, 160 px
  Image image;
  image.pixels = Array<std::uint8_t>::borrow(camera_memory.data(), 2, {120, 160}, 192);
  const auto frame = pipeline.process(image, 0.0);
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(frame->state(), ShapeState::estimated);
}

}  // namespace
}  // namespace weft
