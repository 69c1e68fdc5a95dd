// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/runs/run_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <weft/data/matrix.hpp>

#include "lab/metrics/forms/metrics_report.hpp"
#include "lab/metrics/metrics.hpp"
#include "lab/metrics/shapes/shape_meter.hpp"
#include "test_run.hpp"

namespace weft::lab {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;

Error failure(const TestRun& run) {
  const auto metrics = evaluate_run(run.folder());
  if (metrics) throw std::runtime_error("the damage was not noticed");
  return metrics.error();
}

TEST(RunReader, SaysWhatIsNoRunFolder) {
  const auto nowhere = RunReader::open("/nonexistent/run");
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code, Errc::not_found);
  EXPECT_EQ(nowhere.error().where, "/nonexistent/run");
  for (const std::string file : {"frames.jsonl", "template.npz"}) {
    TestRun run;
    std::filesystem::remove(run.folder() + "/" + file);
    const Error error = failure(run);
    EXPECT_EQ(error.code, Errc::not_found);
    EXPECT_THAT(error.message, HasSubstr(file));
  }
}

TEST(RunReader, ARunOfNoFramesIsEmptyAndNotAnError) {
  TestRun run;
  const auto metrics = evaluate_run(run.folder());
  ASSERT_TRUE(metrics);
  EXPECT_EQ(metrics->counts.frames, 0);
}

TEST(RunReader, ALineCutOffByTheEndOfTheRunIsLeftOutAndSaid) {
  TestRun run;
  run.solved(1.0, TestRun::truth("mdh"));
  run.append_line("{\"frame\": 1, \"stem\": \"f1\", \"sta");
  const auto metrics = evaluate_run(run.folder());
  ASSERT_TRUE(metrics);
  EXPECT_TRUE(metrics->interrupted);
  EXPECT_EQ(metrics->counts.frames, 1);
}

TEST(RunReader, NamesTheLineThatIsWrong) {
  const std::string good = R"({"frame": 0, "state": "none", "failed": false})";
  for (const auto& [line, expected] : {
           std::pair<std::string, std::string>{"{\"frame\": 1, \"sta", "no JSON object"},
           {"[1, 2]", "{...}"},
           {R"({"state": "none", "failed": false})", "'frame'"},
           {R"({"frame": -1, "state": "none", "failed": false})", "'frame'"},
           {R"({"frame": 1, "state": "solved", "failed": false})", "'state'"},
           {R"({"frame": 1, "state": 1, "failed": false})", "'state'"},
           {R"({"frame": 1, "state": "none"})", "'failed'"},
       }) {
    TestRun run;
    run.append_line(good + "\n" + line + "\n");
    const Error error = failure(run);
    EXPECT_EQ(error.code, Errc::syntax) << line;
    EXPECT_THAT(error.where, EndsWith("frames.jsonl:2"));
    EXPECT_THAT(error.message, HasSubstr(expected));
  }
}

TEST(RunReader, RefusesTwoLinesOfOneFrame) {
  TestRun run;
  for (int i = 0; i < 2; ++i) {
    run.append_line("{\"frame\": 3, \"state\": \"none\", \"failed\": false}\n");
  }
  EXPECT_THAT(failure(run).message, HasSubstr("two lines of frame 3"));
}

constexpr const char* kEnds = R"({"end": "end.json", "components": []})";

TEST(RunReader, CountsTheFramesThatARunLeftOutOnPurpose) {
  TestRun run;
  for (const char* frame : {"2", "3", "7"}) {
    run.append_line(std::string("{\"frame\": ") + frame +
                    ", \"state\": \"none\", \"failed\": false}\n");
  }
  EXPECT_THAT(failure(run).message, HasSubstr("has no line of frame 0"));
  run.write_text("manifest.json", R"({"realtime": "latest", "components": []})");
  const auto reader = RunReader::open(run.folder());
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_EQ(reader->lines().size(), 3U);
  EXPECT_EQ(reader->dropped(), 5);
}

TEST(RunReader, NoticesALineThatIsMissing) {
  TestRun between;
  for (const char* frame : {"0", "2"}) {
    between.append_line(std::string("{\"frame\": ") + frame +
                        ", \"state\": \"none\", \"failed\": false}\n");
  }
  EXPECT_THAT(failure(between).message, HasSubstr("has no line of frame 1"));
  TestRun last;
  for (int i = 0; i < 2; ++i) last.solved(1.0, TestRun::truth("mdh"));
  last.write_text("manifest.json", kEnds);
  last.write_text("end.json", R"({"frames": 3, "failed": 0, "stopped": false})");
  EXPECT_THAT(failure(last).message, HasSubstr("has 2 lines of 3 frames"));
  last.write_text("end.json", R"({"frames": 2, "failed": 0, "stopped": false})");
  EXPECT_FALSE(evaluate_run(last.folder())->interrupted);
}

TEST(RunReader, NoticesAManifestThatIsAFolderOrLacksItsComponents) {
  TestRun run;
  run.solved(1.0, TestRun::truth("mdh"));
  run.write_text("manifest.json", R"({"componets": []})");
  EXPECT_THAT(failure(run).message, HasSubstr("has no list 'components'"));
  std::filesystem::remove(run.folder() + "/manifest.json");
  std::filesystem::create_directory(run.folder() + "/manifest.json");
  EXPECT_THAT(failure(run).message, HasSubstr("it is a folder; the run folder is damaged"));
  EXPECT_THAT(failure(run).where, EndsWith("manifest.json"));
}

TEST(RunReader, NoticesALastLineThatIsCutOffInARunThatCameToItsEnd) {
  TestRun run;
  for (int i = 0; i < 2; ++i) run.solved(1.0, TestRun::truth("mdh"));
  run.write_text("manifest.json", kEnds);
  run.write_text("end.json", R"({"frames": 2, "failed": 0, "stopped": false})");
  const std::string lines = run.read_text("frames.jsonl");
  run.write_text("frames.jsonl", lines.substr(0, lines.size() - 1));
  EXPECT_THAT(failure(run).message, HasSubstr("cut off"));
  run.write_text("frames.jsonl", lines.substr(0, lines.size() - 9));
  EXPECT_THAT(failure(run).message, HasSubstr("has 1 lines of 2 frames"));
}

TEST(RunReader, MeasuresWhatIsThereOfARunThatDidNotFinish) {
  TestRun run;
  for (int i = 0; i < 2; ++i) run.solved(1.0, TestRun::truth("mdh"));
  run.write_text("manifest.json", kEnds);
  const auto killed = evaluate_run(run.folder());
  ASSERT_TRUE(killed);
  EXPECT_TRUE(killed->interrupted);
  EXPECT_EQ(killed->counts.frames, 2);
  EXPECT_THAT(to_table(*killed), HasSubstr("2 frames; the run did not finish"));
  run.write_text("end.json", R"({"frames": 2, "failed": 0, "stopped": true})");
  EXPECT_TRUE(evaluate_run(run.folder())->interrupted);
}

TEST(RunReader, NoticesAMissingFileAndMissingRecords) {
  TestRun run;
  run.append_line(R"({"frame": 0, "state": "none", "failed": false, "records": 1})"
                  "\n");
  EXPECT_THAT(failure(run).message, HasSubstr("is missing"));
  run.write_npz(TestRun::frame_name(0),
                {{"ground_truth", host::Record::copy_of(TestRun::truth("mdh"))}});
  EXPECT_TRUE(evaluate_run(run.folder()));
  run.write_text("frames.jsonl", R"({"frame": 0, "state": "none", "failed": false, "records": 2})"
                                 "\n");
  EXPECT_THAT(failure(run).message, HasSubstr("has 1 records where frames.jsonl has 2"));
}

TEST(RunReader, PutsFramesInOrder) {
  TestRun run;
  for (const char* frame : {"2", "0", "1"}) {
    run.append_line(std::string("{\"frame\": ") + frame +
                    ", \"state\": \"none\", \"failed\": false}\n");
  }
  const auto reader = RunReader::open(run.folder());
  ASSERT_TRUE(reader);
  ASSERT_EQ(reader->lines().size(), 3U);
  for (std::uint64_t i = 0; i < 3; ++i) EXPECT_EQ(reader->lines()[i].frame, i);
}

TEST(RunReader, NoticesWhenLineAndRecordDisagree) {
  TestRun without;
  without.append_line("{\"frame\": 0, \"state\": \"estimated\", \"failed\": false}\n");
  EXPECT_THAT(failure(without).message, HasSubstr("is missing"));
  TestRun truth_alone;
  truth_alone.add(ShapeState::estimated, std::nullopt, TestRun::truth("mdh"));
  EXPECT_THAT(failure(truth_alone).message, HasSubstr("'none' where frames.jsonl has 'estimated'"));
  TestRun other;
  other.add(ShapeState::weak, other.vertices(), std::nullopt);
  other.write_text("frames.jsonl", R"({"frame": 0, "state": "lost", "failed": false})");
  EXPECT_THAT(failure(other).where, EndsWith("frames/000000.npz"));
}

TEST(RunReader, RefusesAShapeOfAnotherMesh) {
  TestRun run;
  run.add(ShapeState::estimated, Points3(Points3::Ones(11, 3)), std::nullopt);
  EXPECT_THAT(failure(run).message, HasSubstr("has 11 vertices where the template has 12"));
}

TEST(RunReader, RefusesATruthThatIsNotFinite) {
  TestRun run;
  GroundTruth truth = TestRun::truth("mdh");
  truth.points_m(3, 1) = std::numeric_limits<double>::quiet_NaN();
  run.solved(1.0, truth);
  EXPECT_THAT(failure(run).message, HasSubstr("NaN"));
}

TEST(RunReader, RefusesTruthOnATemplateWithoutPitch) {
  TestRun run;
  Template templ = run.sheet();
  templ.m_per_px = {};
  run.write_template(templ);
  run.solved(1.0, std::nullopt);
  EXPECT_TRUE(evaluate_run(run.folder()));
  run.solved(1.0, TestRun::truth("mdh"));
  EXPECT_THAT(failure(run).message, HasSubstr("m_per_px"));
}

TEST(RunReader, RefusesARecordOfAnotherType) {
  TestRun run;
  run.append_line("{\"frame\": 0, \"state\": \"none\", \"failed\": false}\n");
  run.write_npz(TestRun::frame_name(0), {{"shape", host::Record::copy_of(run.sheet())}});
  EXPECT_THAT(failure(run).message, HasSubstr("template/1 instead of a shape/1"));
}

TEST(RunReader, ListsComponentsThatMayReadTheTruth) {
  TestRun run;
  run.write_text("manifest.json", R"({"components": [{"id": "filters/oracle", "uses_truth": true},
      {"id": "warps/bbs", "uses_truth": false, "implements": "paper"},
      {"id": "sinks/meshes", "implements": "own"}, {"id": "solvers/brunet"}]})");
  EXPECT_THAT(evaluate_run(run.folder())->truth_users, ElementsAre("filters/oracle"));
  EXPECT_THAT(evaluate_run(run.folder())->implements, ElementsAre("warps/bbs: paper"));
}

TEST(RunReader, ReadsTheFramesOfARunWhoseManifestIsLost) {
  TestRun run;
  run.solved(1.0, TestRun::truth("mdh"));
  run.write_text("end.json", R"({"frames": 1, "failed": 0, "stopped": false})");
  for (const char* text : {"", "{\"comp"}) {
    run.write_text("manifest.json", text);
    const auto metrics = evaluate_run(run.folder());
    ASSERT_TRUE(metrics) << metrics.error().message;
    EXPECT_EQ(metrics->counts.frames, 1);
    ASSERT_EQ(metrics->warnings.size(), 1U);
    EXPECT_THAT(metrics->warnings[0], HasSubstr("/manifest.json: is no JSON object"));
  }
  std::filesystem::remove(run.folder() + "/manifest.json");
  EXPECT_TRUE(evaluate_run(run.folder())->warnings.empty()) << "other programs write none";
  run.write_text("pipeline.yaml", "weft: 1\n");
  EXPECT_THAT(evaluate_run(run.folder())->warnings[0], HasSubstr("/manifest.json: is missing"));
}

TEST(RunReader, LeavesOutWhatAPowerCutHasTakenFromARunThatHadNotEnded) {
  TestRun run;
  for (int i = 0; i < 3; ++i) run.solved(1.0, TestRun::truth("mdh"));
  run.write_text("manifest.json", kEnds);
  run.write_text(TestRun::frame_name(1), "");
  const auto metrics = evaluate_run(run.folder());
  ASSERT_TRUE(metrics) << metrics.error().message;
  EXPECT_EQ(metrics->counts.frames, 1);
  ASSERT_EQ(metrics->warnings.size(), 1U);
  EXPECT_THAT(metrics->warnings[0], HasSubstr("frames from 1 on are omitted"));
  run.write_text("end.json", R"({"frames": 3, "failed": 0, "stopped": false})");
  EXPECT_FALSE(evaluate_run(run.folder())) << "a run that came to its end was written to the disk";
}

TEST(RunReader, ACutFileIsAnErrorThatNamesIt) {
  for (const std::string& name : {std::string("template.npz"), TestRun::frame_name(0)}) {
    TestRun run;
    run.solved(1.0, TestRun::truth("mdh"));
    const std::string whole = run.read_text(name);
    for (const std::size_t size :
         {std::size_t{0}, std::size_t{10}, whole.size() / 2, whole.size() - 1}) {
      run.write_text(name, whole.substr(0, size));
      EXPECT_THAT(failure(run).where, EndsWith(name)) << size;
    }
  }
}

TEST(RunReader, CountsTheFilesThatAreDamaged) {
  TestRun run;
  for (int i = 0; i < 4; ++i) run.solved(1.0, TestRun::truth("mdh"));
  for (const int i : {1, 3}) run.write_text(TestRun::frame_name(i), "PK");
  const Error error = failure(run);
  EXPECT_THAT(error.where, EndsWith("frames/000001.npz"));
  EXPECT_THAT(error.message, HasSubstr("2 of 4 frames are damaged"));
  EXPECT_THAT(error.message, HasSubstr("frames/000003.npz"));
}

TEST(RunReader, AFlippedByteNeverGivesAnotherNumber) {
  TestRun run;
  run.solved(3.0, TestRun::truth("mdh"));
  const std::string name = TestRun::frame_name(0), whole = run.read_text(name);
  const auto reader = RunReader::open(run.folder());
  const auto meter = ShapeMeter::create(reader->sheet());
  int noticed = 0;
  constexpr std::size_t kStep = 7;  // prime to the 64 bytes to which headers are padded
  for (std::size_t i = 0; i < whole.size(); i += kStep) {
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ 0x55);
    run.write_text(name, changed);
    const auto frame = reader->read(reader->lines()[0]);
    noticed += frame ? 0 : 1;
    // Bytes that no reader needs (times, padding, a name that becomes another slot) may change.
    if (!frame || !frame->ground_truth) continue;
    const auto errors =
        meter->errors(frame->shape->vertices_m.matrix<3>(), *frame->ground_truth, Alignment::none);
    for (const double distance_m : errors->distances_m) {
      ASSERT_NEAR(distance_m, 0.003, 1e-12) << "byte " << i;
    }
  }
  EXPECT_GT(noticed, static_cast<int>(whole.size() / kStep) / 4);
}

}  // namespace
}  // namespace weft::lab
