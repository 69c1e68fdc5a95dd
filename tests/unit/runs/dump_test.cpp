// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "pipeline/dumps/replay.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::head;
using ::testing::IsEmpty;
using testing::Ran;

/// Runs that dump stages, and replays of them.
class DumpTest : public testing::PipelineTest {
 protected:
  /// A filter with a nested warp; a solver that reads the warp, one that reads previous.shape.
  static std::string pipeline() {
    return head("{frames: 3}") +
           "seed: 41\n"
           "stages:\n"
           "  - {use: matchers/test.pattern, as: near}\n"
           "  - {use: matchers/test.pattern, as: far}\n"
           "  - {use: matchers/test.merge, as: all, from: {correspondences: [near, far]}}\n"
           "  - {use: filters/test.warped}\n"
           "  - {use: warps/test.scripted}\n"
           "  - {use: passes/test.scripted}\n"
           "  - {use: solvers/test.warped}\n"
           "  - {use: solvers/test.scripted, as: plane, params: {no_result_at: [1], "
           "degenerate_at: [2]}}\n";
  }

  Ran run_and_dump(const std::string& text, const std::vector<std::string>& stages) const {
    Ran ran;
    ran.folder = path("run");
    const auto [pipeline, report] = check_pipeline(write(text), registry_, ran.folder);
    EXPECT_TRUE(report.ok()) << report.text();
    const std::atomic<bool> cancel{false};
    if (report.ok())
      ran.summary = run_pipeline(pipeline, ran.folder, ran, cancel, {.dumped = stages});
    return ran;
  }

  std::string file(const std::string& stage, std::uint64_t frame) const {
    return path("run/dumps/" + stage + "/") + dumped_call_name(frame);
  }

  DumpedStage stage(const std::string& name) const {
    const auto found = find_dump(path("run"), name);
    EXPECT_TRUE(found) << found.error().message;
    auto read = read_dumped_stage(*found);
    EXPECT_TRUE(read) << read.error().where << read.error().message;
    return *std::move(read);
  }

  std::vector<std::string> replay(const std::string& name, std::uint64_t frame,
                                  const std::string& params = {}) const {
    const DumpedStage dumped = stage(name);
    const auto replay = Replay::create(registry_, dumped, params);
    if (!replay) return {replay.error().where + ": " + replay.error().message};
    EXPECT_FALSE((*replay)->is_rebuilt());
    const auto call = read_call(file(name, frame), dumped);
    if (!call) return {call.error().where + ": " + call.error().message};
    const Replayed replayed = (*replay)->run(*call, 2);
    EXPECT_EQ(replayed.ms.size(), 2U);
    return replayed.differences;
  }
};

TEST_F(DumpTest, HoldsExactlyWhatWentInAndCameOut) {
  const Ran ran = run_and_dump(pipeline(), {"all", "plane"});
  ASSERT_TRUE(ran.summary) << ran.summary.error().message;
  ASSERT_EQ(ran.frames.size(), 3U);
  for (const FrameResult& frame : ran.frames) {
    ASSERT_EQ(frame.calls.size(), 2U);
    for (const StageCall& kept : frame.calls) {
      const auto read = read_call(file(kept.stage, frame.index), stage(kept.stage));
      ASSERT_TRUE(read) << read.error().message;
      EXPECT_EQ(read->frame, frame.index);
      EXPECT_THAT(differences(kept.outcome, read->outcome), IsEmpty());
      ASSERT_EQ(read->inputs.size(), kept.inputs.size());
      for (std::size_t i = 0; i < kept.inputs.size(); ++i) {
        EXPECT_EQ(read->inputs[i].slot, kept.inputs[i].slot);
        EXPECT_EQ(read->inputs[i].producer, kept.inputs[i].producer);
        const host::Outcome before{WEFT_OK, {}, {{"in", kept.inputs[i].record}}};
        const host::Outcome after{WEFT_OK, {}, {{"in", read->inputs[i].record}}};
        EXPECT_THAT(differences(before, after), IsEmpty()) << kept.inputs[i].slot;
      }
    }
  }
  std::vector<std::string> merged;
  for (const GivenRecord& input : ran.frames[0].calls[0].inputs) merged.push_back(input.slot);
  EXPECT_THAT(merged, ElementsAre("correspondences", "correspondences"));
}

TEST_F(DumpTest, HoldsAndReplaysArraysOfThirdPartiesAndEvidenceOfAnyType) {
  const Ran ran = run_and_dump(pipeline(), {"filters"});
  ASSERT_TRUE(ran.summary) << ran.summary.error().message;
  const auto call = read_call(file("filters", 0), stage("filters"));
  ASSERT_TRUE(call) << call.error().message;
  const auto mask = host::view_as<InlierMask>(*call->outcome.find("inlier_mask"));
  ASSERT_TRUE(mask);
  const auto* kept = mask->others.find<std::uint8_t>("x.acme.kept");
  ASSERT_NE(kept, nullptr);
  EXPECT_EQ(kept->rows(), mask->kept.rows());
  const auto* count = mask->diag.find<std::int32_t>("count");
  ASSERT_NE(count, nullptr);
  EXPECT_EQ(*count->data(), mask->kept.rows());
  EXPECT_EQ(ran.number(0, "filters", "diag.count"), static_cast<double>(mask->kept.rows()));
  EXPECT_THAT(replay("filters", 0), IsEmpty());
}

TEST_F(DumpTest, KeepsNothingUnasked) {
  const Ran ran = run(pipeline());
  EXPECT_THAT(ran.frames.at(0).calls, IsEmpty());
  EXPECT_FALSE(std::filesystem::exists(path("run/dumps")));
}

TEST_F(DumpTest, ReplaysEveryKindOfStageToTheSameBits) {
  const std::vector<std::string> stages{"all", "filters", "warps", "passes", "solvers", "plane"};
  const Ran ran = run_and_dump(pipeline(), stages);
  for (const std::string& name : stages) {
    for (std::uint64_t frame : {0, 1, 2}) {
      EXPECT_THAT(replay(name, frame), IsEmpty()) << name << " in frame " << frame;
    }
  }
  // The solver was given what the frame before had made, and evaluated a warp of another stage.
  const auto plane = read_call(file("plane", 1), stage("plane"));
  const auto has_previous = [](const GivenRecord& input) { return input.slot == "previous.shape"; };
  EXPECT_EQ(std::count_if(plane->inputs.begin(), plane->inputs.end(), has_previous), 1);
  const auto warped = read_call(file("solvers", 0), stage("solvers"));
  EXPECT_EQ(warped->inputs.back().producer, "warps");
}

TEST_F(DumpTest, ReplaysADetectorAndAStageThatFails) {
  run_and_dump(testing::chain({{"matchers", "{error_at: [1], throw_at: [2]}"}}, "max_failed: 9"),
               {"detectors", "matchers"});
  for (const char* name : {"detectors", "matchers"}) {
    for (std::uint64_t frame : {0, 1, 2}) EXPECT_THAT(replay(name, frame), IsEmpty()) << name;
  }
}

TEST_F(DumpTest, HoldsCopiesOfWhatLayOnADevice) {
  run_and_dump(testing::head() +
                   "stages:\n  - use: detectors/test.device\n  - use: matchers/test.device\n"
                   "  - use: warps/test.scripted\n  - use: passes/test.scripted\n"
                   "  - use: solvers/test.scripted\n",
               {"detectors", "matchers"});
  EXPECT_THAT(replay("detectors", 1), IsEmpty());
  EXPECT_THAT(replay("matchers", 1),
              ElementsAre("out.correspondences/score: 24 of 24 values differ, by at most 1"))
      << "the same matches, from arrays that are here now";
}

TEST_F(DumpTest, TellsWhatOtherParametersChange) {
  run_and_dump(pipeline(), {"plane", "filters"});
  EXPECT_THAT(replay("plane", 0, "{distance_m: 0.25}"),
              ElementsAre("out.shape/vertices_m: 90 of 90 values differ, by at most 0.05"));
  EXPECT_THAT(
      replay("plane", 0, "{no_result_at: [0]}"),
      ElementsAre("status: no_result (scripted no result) instead of ok", "out.shape: is missing"));
  EXPECT_THAT(
      replay("filters", 0, "{warp: {params: {error_at: [0]}}}"),
      ElementsAre("status: error (scripted error) instead of ok", "out.inlier_mask: is missing"));
}

TEST_F(DumpTest, DrawsFromTheSeedOfTheRun) {
  run_and_dump(pipeline(), {"plane"});
  DumpedStage other = stage("plane");
  ++other.seed;
  const auto replay = Replay::create(registry_, other, {});
  ASSERT_TRUE(replay);
  const auto call = read_call(file("plane", 0), other);
  EXPECT_THAT((*replay)->run(*call, 1).differences,
              ElementsAre(HasSubstr("out.shape/diag.draw: 1 of 1 value differs, by at most 0.")));
}

TEST_F(DumpTest, RefusesMistakesWithTheirPlace) {
  run_and_dump(pipeline(), {"plane"});
  EXPECT_THAT(replay("plane", 0, "{distance: 1}"),
              ElementsAre("--params:1:2: solvers/test.scripted has no parameter 'distance'; did "
                          "you mean 'distance_m'?"));
  EXPECT_THAT(replay("plane", 0, "{"), ElementsAre(HasSubstr("--params")));
  EXPECT_THAT(replay("plane", 0, "3"), ElementsAre(HasSubstr("must be a map")));
  EXPECT_EQ(find_dump(path("run"), "plan").error().message,
            "the stage 'plan' was not dumped; did you mean 'plane'?");
  EXPECT_EQ(find_dump(file("plane", 0), "filters").error().message,
            "the dump has the stage 'plane', not 'filters'");
  EXPECT_EQ(find_dump(path("nothing"), "plane").error().code, Errc::io);
}

TEST_F(DumpTest, RefusesDamagedFiles) {
  run_and_dump(pipeline(), {"plane"});
  const DumpedStage plane = stage("plane");
  const std::string whole = testing::read_text(file("plane", 0));
  write(whole.substr(0, whole.size() / 2), "cut.npz");
  const auto cut = read_call(path("cut.npz"), plane);
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().where, path("cut.npz"));
  const auto strange = read_call(path("run/template.npz"), plane);
  ASSERT_FALSE(strange);
  EXPECT_THAT(strange.error().message, HasSubstr("lacks the slot 'call'"));
  write("weft: 1\nstage: plane\n", "run/dumps/plane/stage.yaml");
  const auto poor = read_dumped_stage(path("run/dumps/plane"));
  ASSERT_FALSE(poor);
  EXPECT_THAT(poor.error().message, HasSubstr("names no stage with its component"));
}

TEST_F(DumpTest, RefusesAStageThatIsNotThereBeforeItRuns) {
  for (const auto& [name, hint] : std::map<std::string, std::string>{
           {"plan", "did you mean 'plane'?"},
           {"sinks", "there are: near, far, all, filters, warps, passes, solvers, plane"}}) {
    const Ran ran = run_and_dump(pipeline(), {name});
    ASSERT_FALSE(ran.summary);
    EXPECT_EQ(ran.summary.error().code, Errc::not_found);
    EXPECT_EQ(ran.summary.error().message, "no stage is called '" + name + "'; " + hint);
    EXPECT_FALSE(std::filesystem::exists(path("run")));
  }
}

TEST(Differences, TellOfArraysThatAreMissingNewOrOfAnotherShape) {
  const auto record = [](std::int64_t length, const char* extra) {
    auto made = std::make_shared<host::Record>("inlier_mask/1");
    made->allocate("kept", WEFT_U8, 1, &length);
    *static_cast<double*>(made->allocate(extra, WEFT_F64, 0, nullptr)) = 1.0;
    return made;
  };
  const host::Outcome before{WEFT_OK, {}, {{"mask", record(2, "diag.a")}}};
  const host::Outcome after{WEFT_OK, {}, {{"mask", record(3, "diag.b")}}};
  EXPECT_THAT(differences(before, before), IsEmpty());
  EXPECT_THAT(differences(before, after),
              ElementsAre("out.mask/kept: has the shape [3] instead of [2]",
                          "out.mask/diag.a: is missing", "out.mask/diag.b: is new"));
  EXPECT_THAT(differences({}, after), ElementsAre("out.mask: is new"));
}

TEST(Differences, CountNumbersThatBecameNaN) {
  const auto record = [](double value) {
    auto made = std::make_shared<host::Record>("shape/1");
    *static_cast<double*>(made->allocate("diag.a", WEFT_F64, 0, nullptr)) = value;
    return made;
  };
  const host::Outcome number{WEFT_OK, {}, {{"shape", record(1.0)}}};
  const host::Outcome none{WEFT_OK, {}, {{"shape", record(std::nan(""))}}};
  EXPECT_THAT(differences(none, none), IsEmpty());
  EXPECT_THAT(
      differences(number, none),
      ElementsAre("out.shape/diag.a: 1 of 1 value differs, some between a number and none"));
}

}  // namespace
}  // namespace weft
