// SPDX-License-Identifier: Apache-2.0
#include "report/runs/run_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

#include "fake_run.hpp"
#include "report/runs/run_page.hpp"
#include "report/runs/video_pictures.hpp"
#include "support/child.hpp"

namespace weft::evaluation {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

RunData read(const TestRun& run) {
  auto data = read_run_data(run.folder());
  if (!data) throw std::runtime_error(data.error().where + ": " + data.error().message);
  return *std::move(data);
}

TEST(RunReport, SaysHowFarOffARunIsAndWhereAndWhy) {
  TestRun run;
  write_eight_frames(run);
  const RunData data = read(run);
  EXPECT_THAT(
      sentences_of(data),
      ElementsAre("7 of 8 frames have a shape of their own; 1 has none.",
                  "The mean 3D error is 3 mm over 7 frames with truth; the worst, frame 6, is "
                  "off by 6 mm. 1 of 8 frames with truth failed.",
                  "The stages of a frame take 6 ms (median), 5 of them solvers.",
                  "At frame 2: setup: the focal length seems wrong"));
  const TextTable reasons = reasons_sheet(data);
  ASSERT_EQ(reasons.rows.size(), 1U);
  EXPECT_EQ(reasons.rows[0].cells[1].shown, "had no result");
  EXPECT_EQ(reasons.rows[0].cells[2].shown, "3 matches <are> too few");
  EXPECT_EQ(reasons.rows[0].cells[4].shown, "7");
}

TEST(RunReport, ShowsTheWorstFramesWithTheirPicturesAndShapes) {
  TestRun run;
  write_eight_frames(run);
  const RunData data = read(run);
  ASSERT_EQ(data.worst.size(), 6U);
  EXPECT_EQ(data.worst[0].frame, 6U);
  EXPECT_EQ(data.worst[5].frame, 1U);
  EXPECT_EQ(data.worst[0].jpeg, "\xFF\xD8pppppp");
  ASSERT_EQ(data.view.frames.size(), 8U);
  const ViewFrame& worst = data.view.frames[6];
  ASSERT_EQ(worst.placed.size(), 15U);
  EXPECT_NEAR(worst.placed[2] - worst.truth[2], 0.006, 1e-6);
}

TEST(RunReport, TakesNoPicturesOfAVideoThatHasOtherFrames) {
  TestRun run;
  write_eight_frames(run);
  run.write_text("overlay.avi", video(kRunFrames + 1));
  EXPECT_EQ(read(run).worst[0].jpeg, "");
  run.write_text("overlay.avi", video(kRunFrames).substr(0, 200));
  EXPECT_EQ(read(run).worst[0].jpeg, "");
  run.write_text("overlay.avi", "RIFF");
  EXPECT_EQ(video_pictures(run.folder() + "/overlay.avi", {0}).count, 0U);
  EXPECT_EQ(video_pictures(run.folder() + "/nowhere.avi", {0}).count, 0U);
}

TEST(RunReport, WritesAPageAndTables) {
  TestRun run;
  write_eight_frames(run);
  std::filesystem::create_directories(run.folder() + "/assets");
  run.write_text("assets/report.css", "body {}");
  run.write_text("assets/report.js", "start()");
  const auto files = write_run_report(run.folder(), {"", run.folder() + "/assets"});
  ASSERT_TRUE(files) << files.error().message;
  const std::string page = run.read_text("report.html");
  EXPECT_THAT(page, HasSubstr("The mean 3D error is 3 mm"));
  EXPECT_THAT(page, HasSubstr("3 matches &lt;are&gt; too few"));
  EXPECT_THAT(page, HasSubstr("<figure id=\"figure-run\">"));
  EXPECT_THAT(page, HasSubstr("<figure data-frame=\"6\">"));
  EXPECT_THAT(page, Not(HasSubstr("http")));
  EXPECT_THAT(run.read_text("report/frames.csv"), HasSubstr("\n6,estimated,6,6,0.9,6,\n"));
  EXPECT_THAT(run.read_text("report/stages.csv"), HasSubstr("\nfilters,1,1,1,8\n"));
  EXPECT_THAT(run.read_text("report/tables.md"), HasSubstr("- 7 of 8 frames have a shape"));
}

TEST(RunReport, SaysSoWhereARunHasNoTruth) {
  TestRun run;
  for (int t = 0; t < kRunFrames; ++t) {
    run.say(0.1 * t);
    run.solved(1.0, std::nullopt);
  }
  const RunData data = read(run);
  EXPECT_THAT(sentences_of(data)[1], HasSubstr("The run has no truth"));
  EXPECT_TRUE(data.view.frames[0].truth.empty());
}

TEST(RunReport, NamesWhatIsWrongWithAFolder) {
  const std::string scratch = ::testing::TempDir() + "weft_no_run_" + std::to_string(getpid());
  std::filesystem::create_directories(scratch);
  const auto report = [&](const std::string& folder) {
    return testing::Child({WEFT_PROGRAM, "report", folder}, scratch + "/program").wait();
  };
  const auto neither = report(scratch);
  EXPECT_EQ(neither.exit_code, 3);
  EXPECT_THAT(neither.err, HasSubstr("neither the folder of a run"));
  EXPECT_THAT(neither.err, HasSubstr("weft run"));
  const auto nowhere = report(scratch + "/nowhere");
  EXPECT_EQ(nowhere.exit_code, 3);
  EXPECT_THAT(nowhere.err, HasSubstr("there is no such folder"));
  TestRun damaged;
  write_eight_frames(damaged);
  damaged.write_text("frames/000003.npz", "PK damaged");
  const auto refused = report(damaged.folder());
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("000003.npz"));
  std::filesystem::remove_all(scratch);
}

}  // namespace
}  // namespace weft::evaluation
