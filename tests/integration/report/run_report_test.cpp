// SPDX-License-Identifier: Apache-2.0
#include "lab/report/runs/run_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <tuple>

#include "fake_run.hpp"
#include "lab/report/runs/png_picture.hpp"
#include "lab/report/runs/run_page.hpp"
#include "lab/report/runs/video_pictures.hpp"
#include "support/child.hpp"

namespace weft::lab {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

RunData read(const TestRun& run) {
  auto data = read_run_data(run.folder(), "sinks/unwarped");
  if (!data) throw std::runtime_error(data.error().where + ": " + data.error().message);
  return *std::move(data);
}

TEST(RunReport, SaysHowFarOffARunIsAndWhereAndWhy) {
  TestRun run;
  write_eight_frames(run);
  const RunData data = read(run);
  EXPECT_THAT(
      sentences_of(data),
      ElementsAre("7 of 8 frames were reconstructed; 1 has no shape (7).",
                  "The mean 3D error is 3 mm over 7 frames with truth; the worst, frame 6, is "
                  "off by 6 mm. 1 of 8 frames with truth failed.",
                  "The stages of a frame take 6 ms (median), 5 of them solvers.",
                  "At frame 2: setup: the focal length seems wrong"));
  const TextTable reasons = reasons_sheet(data);
  ASSERT_EQ(reasons.rows.size(), 1U);
  EXPECT_EQ(reasons.rows[0].cells[1].shown, "had no result");
  EXPECT_EQ(reasons.rows[0].cells[2].shown, "3 matches <are> too few");
  EXPECT_EQ(reasons.rows[0].cells[4].shown, "1");  // frames without a measured shape
  EXPECT_EQ(reasons.rows[0].cells[5].shown, "7");
}

TEST(RunReport, CountsNoTimeOfAStageThatWasSkipped) {
  TestRun run;
  write_eight_frames(run);
  const TextTable stages = stages_sheet(read(run));
  const auto solvers = std::find_if(stages.rows.begin(), stages.rows.end(), [](const TextRow& row) {
    return row.cells[0].shown == "solvers";
  });
  ASSERT_NE(solvers, stages.rows.end());
  EXPECT_EQ(solvers->cells[2].shown, "5.00");  // mean, ms
  EXPECT_EQ(solvers->cells[4].shown, "7");     // frames, of 8
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
  EXPECT_THAT(run.read_text("report/frames.csv"), HasSubstr("\n6,estimated,6,6,0.9,,,6,\n"));
  EXPECT_THAT(run.read_text("report/stages.csv"), HasSubstr("\nfilters,1,1,1,8\n"));
  EXPECT_THAT(run.read_text("report/tables.md"), HasSubstr("- 7 of 8 frames were reconstructed"));
}

TEST(RunReport, ShowsTheWorstTheMedianAndTheBestFrameAgainstTheFlatPrint) {
  TestRun run;
  write_eight_frames(run);
  EXPECT_TRUE(read(run).print.frames.empty());
  compare_with_print(run);
  const RunData data = read(run);
  EXPECT_THAT(sentences_of(data)[2], HasSubstr("50.0 % of 56 patches in 7 frames are within 1 mm"));
  ASSERT_EQ(data.print.frames.size(), 3U);
  EXPECT_EQ(data.print.width_px, 60);
  for (const auto& [index, rank, frame, media_type] :
       {std::tuple{0U, "Worst", 6U, "image/png"}, std::tuple{1U, "Median", 3U, "image/jpeg"},
        std::tuple{2U, "Best", 0U, ""}}) {
    const PrintFrame& shown = data.print.frames[index];
    EXPECT_EQ(shown.rank, rank);
    EXPECT_EQ(shown.frame, frame);
    EXPECT_EQ(shown.patches.size(), 8U);
    EXPECT_EQ(shown.unwarped.empty() ? "" : shown.media_type, media_type);
  }
  EXPECT_DOUBLE_EQ(data.print.frames[0].patches[1].u_px, 11.0);
  EXPECT_DOUBLE_EQ(data.print.frames[0].patches[1].dv_mm, 2.5);
  EXPECT_TRUE(std::isnan(data.print.frames[0].patches[7].dv_mm));
}

TEST(RunReport, DrawsArrowsOverTheFlatPrintAndOverTheUnwarpedImage) {
  TestRun run;
  write_eight_frames(run);
  compare_with_print(run);
  const RunData data = read(run);
  const std::string page = flat_print_html(data.print, data.metrics);
  EXPECT_THAT(page, HasSubstr("It is 5 times as long as the displacement, but at most 1/12"))
      << "2.5 mm on a print of 300 mm";
  // Patch 1 of frame 6: 2.5 mm along v, texels of 4 mm, five times.
  EXPECT_THAT(page, HasSubstr("M11.0 25.0l0.0 3.1"));
  EXPECT_THAT(page, HasSubstr("class=\"arrow missing\""));
  EXPECT_THAT(page, HasSubstr("Worst frame, 6: 1 of 8 patches within 1 mm, 1 within 2 mm, 1 not "
                              "found; median 2.50 mm"));
  const auto count = [&](const std::string& text) {
    std::size_t found = 0, at = 0;
    while ((at = page.find(text, at)) != page.npos) ++found, ++at;
    return found;
  };
  EXPECT_EQ(count("<svg"), 5U) << "the best frame has no unwarped image";
  EXPECT_EQ(count("id=\"flat-print\""), 1U) << "the page has the print once";
  EXPECT_EQ(count("<use href=\"#flat-print\"/>"), 2U);
  const TextTable sheet = frames_sheet(data);
  EXPECT_EQ(sheet.columns[5].field, "registration_within_1mm_percent");
  EXPECT_EQ(sheet.rows[6].cells[5].shown, "12.5");
}

TEST(RunReport, MakesLargePicturesSmaller) {
  const auto size_of = [](const std::string& png) {
    const std::vector<std::uint8_t> bytes(png.begin(), png.end());
    return cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  };
  Array<std::uint8_t> grey({5, 3}, std::uint8_t{40});
  grey(0, 0) = 80;
  const cv::Mat small = size_of(png_of(grey, 3));
  ASSERT_EQ(small.size(), cv::Size(2, 3));
  EXPECT_EQ(small.at<std::uint8_t>(0, 0), 50);
  EXPECT_EQ(small.at<std::uint8_t>(2, 1), 40);
  Array<std::uint8_t> colour({4, 4, 3}, std::uint8_t{0});
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) colour.row(y)[3 * x] = 200;
  }
  const cv::Mat whole = size_of(smaller_png(png_of(colour, 4), 2));
  ASSERT_EQ(whole.size(), cv::Size(2, 2));
  EXPECT_EQ(whole.at<cv::Vec3b>(1, 1), cv::Vec3b(200, 0, 0)) << "blue stays blue";
  EXPECT_EQ(smaller_png("PNG, damaged", 2), "");
  EXPECT_EQ(png_of({}, 2), "");
}

TEST(RunReport, SaysSoWhereARunHasNoTruth) {
  TestRun run;
  for (int t = 0; t < kRunFrames; ++t) {
    run.say(0.1 * t);
    run.solved(1.0, std::nullopt);
  }
  const RunData data = read(run);
  EXPECT_THAT(sentences_of(data)[1], HasSubstr("The run has no truth"));
  const std::string page = page_html(page_of(data, true), {});
  EXPECT_THAT(page, HasSubstr("<h2>Shapes in 3D</h2>"));
  EXPECT_THAT(page, HasSubstr("<div id=\"viewer\" class=\"without-truth\">"));
  for (const char* absent :
       {"Estimate and truth", "Worst frames", "mean 3D error", "of the worst point"}) {
    EXPECT_THAT(page, Not(HasSubstr(absent))) << absent;
  }
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
}  // namespace weft::lab
