// SPDX-License-Identifier: Apache-2.0
// Experiments with exact truth, run and measured as users do.
#include <gmock/gmock.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "lab/metrics/metrics.hpp"
#include "lab/metrics/runs/run_reader.hpp"
#include "pipeline/runs/run.hpp"
#include "pipeline/survey/data_survey.hpp"

namespace weft {
namespace {

const FileSources kSources{"sources/images", "sources/matches", "sources/video"};

namespace fs = std::filesystem;
using lab::RunMetrics;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Silent final : public RunObserver {
 public:
  void started(std::int64_t) override {}
  void frame_done(const FrameResult&) override {}
};

/// A separate folder, and pipelines that write into it.
class Evidence : public ::testing::Test {
 protected:
  Evidence() {
    std::string pattern = (fs::temp_directory_path() / "weft_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
  }
  ~Evidence() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  RunMetrics measure(const std::string& pipeline, const std::vector<std::string>& settings = {}) {
    const std::string run = path("run" + std::to_string(runs_++));
    const auto [checked, report] = check_pipeline(pipeline, registry_, run, settings);
    if (!report.ok()) throw std::runtime_error(report.text());
    Silent silent;
    const std::atomic<bool> cancel{false};
    const auto summary = run_pipeline(checked, run, silent, cancel);
    if (!summary) throw std::runtime_error(summary.error().message);
    EXPECT_EQ(summary->failed, 0);
    const auto metrics = lab::evaluate_run(run);
    if (!metrics) throw std::runtime_error(metrics.error().message);
    return *metrics;
  }

  /// The texture of 0.297 m width, flat and parallel to the image at `distance_m`, with depth.
  void write_frame(const cv::Size& size_px, double focal_px, double distance_m) const {
    for (const char* part : {"frames", "depth"}) fs::create_directories(folder_ / part);
    const cv::Mat texture = cv::imread(WEFT_TEXTURE, cv::IMREAD_GRAYSCALE);
    const double scale = focal_px * 0.297 / distance_m / texture.cols;
    const cv::Point2d centre(0.5 * (size_px.width - 1), 0.5 * (size_px.height - 1));
    const cv::Matx23d place(scale, 0, centre.x - scale * 0.5 * (texture.cols - 1), 0, scale,
                            centre.y - scale * 0.5 * (texture.rows - 1));
    cv::Mat image;
    cv::warpAffine(texture, image, place, size_px, cv::INTER_AREA, cv::BORDER_CONSTANT, 120);
    cv::imwrite(path("frames/a.png"), image);
    const auto raw = static_cast<std::uint16_t>(std::lround(1e4 * distance_m));
    cv::imwrite(path("depth/a.png"), cv::Mat(size_px, CV_16UC1, cv::Scalar(raw)));
    std::ofstream(path("camera.yaml"))
        << "{fx: " << focal_px << ", fy: " << focal_px << ", cx: " << centre.x
        << ", cy: " << centre.y << ", width: " << size_px.width << ", height: " << size_px.height
        << "}\n";
  }

  fs::path folder_;
  host::Registry registry_ = host::Registry::scan(host::search_path({}));
  int runs_ = 0;
};

TEST_F(Evidence, MatchTrialsGiveRatesOfAFilterWithoutAnyImage) {
  const RunMetrics metrics =
      measure(WEFT_PIPELINES "/match_trials.yaml",
              {"source.trials=12", "source.matches=500", "source.inlier_rate=0.5"});
  ASSERT_EQ(metrics.filters.size(), 1U);
  const auto& filter = metrics.filters.front();
  EXPECT_EQ(filter.frames, 12);
  EXPECT_EQ(filter.labelled, 12 * 500);
  EXPECT_GT(filter.tpr_percent, 97.0);
  EXPECT_LT(filter.fpr_percent, 1.0);
  EXPECT_EQ(metrics.counts.none, 12) << "no solver, no shape";
  EXPECT_EQ(metrics.all.failures(), 0) << "nor a failure of one";
}

TEST_F(Evidence, TheOracleRejectsEveryMismatchAndNothingElse) {
  const RunMetrics metrics = measure(WEFT_PIPELINES "/match_trials.yaml",
                                     {"source.trials=5", "filters.use=filters/oracle"});
  ASSERT_EQ(metrics.filters.size(), 1U);
  EXPECT_EQ(metrics.filters.front().tpr_percent, 100.0);
  EXPECT_EQ(metrics.filters.front().fpr_percent, 0.0);
  EXPECT_THAT(metrics.truth_users, ElementsAre("filters/oracle"));
}

class DepthCamera : public Evidence, public ::testing::WithParamInterface<cv::Size> {};

TEST_P(DepthCamera, MeasuresTheShapeAtTheKeptMatches) {
  const cv::Size size_px = GetParam();
  write_frame(size_px, 1.3 * size_px.width, 0.55);
  std::ofstream(path("p.yaml")) << "weft: 1\nextends: '" WEFT_PIPELINES "/sparse.yaml'\n"
                                << "without: [overlay, meshes]\nsource:\n  use: sources/images\n"
                                << "  params: {path: frames/*.png, camera: camera.yaml, "
                                << "depth: depth/*.png, depth_unit_m: 0.0001}\n";
  const RunMetrics metrics = measure(path("p.yaml"));
  ASSERT_EQ(metrics.depth.frames, 1);
  EXPECT_GT(metrics.depth.matches, 100);
  EXPECT_EQ(metrics.depth.without_depth, 0);
  EXPECT_LT(metrics.depth.mean_mm, 1.0);
  EXPECT_EQ(metrics.all.solved_error.frames, 0) << "there are no true points";
  const auto reader = lab::RunReader::open(path("run0"));
  const auto frame = reader->read(reader->lines().front());
  EXPECT_FALSE(frame->ground_truth->depth_m.present()) << "kept at the matches only";
}

INSTANTIATE_TEST_SUITE_P(Sizes, DepthCamera,
                         ::testing::Values(cv::Size(640, 480), cv::Size(1280, 720)));

TEST_F(Evidence, ASurveySaysWhatAFolderWithDepthHolds) {
  write_frame({640, 480}, 800.0, 0.5);
  cv::imwrite(path("frames/b.png"), cv::Mat(480, 640, CV_8UC3));
  const auto layout = find_data_layout(folder_.string(), kSources);
  ASSERT_TRUE(layout) << layout.error().message;
  EXPECT_EQ(layout->kind, "frames with depth");
  const std::atomic<bool> cancel{false};
  const auto survey = survey_data(*layout, registry_, cancel);
  ASSERT_TRUE(survey) << survey.error().message;
  EXPECT_EQ(survey->frames, 2);
  EXPECT_EQ(survey->grey, 1);
  EXPECT_EQ(survey->colour, 1);
  EXPECT_EQ(survey->camera.fx, 800.0);
  ASSERT_EQ(survey->truth.count("depth"), 1U);
  EXPECT_EQ(survey->truth.at("depth").frames, 1);
  EXPECT_EQ(survey->truth.at("depth").depth_percent, 100.0);
  EXPECT_NEAR(survey->truth.at("depth").furthest_m, 5.0, 1e-6);  // the unit is a millimetre
  EXPECT_THAT(survey->findings, ElementsAre("1 of 2 frames have no truth",
                                            "some images are grey and some have colours"));
  EXPECT_TRUE(survey->failures.empty());
}

TEST_F(Evidence, ASurveyCountsFramesThatCannotBeRead) {
  write_frame({640, 480}, 800.0, 0.5);
  std::ofstream(path("frames/b.png")) << "no image";
  const std::atomic<bool> cancel{false};
  const auto survey = survey_data(*find_data_layout(folder_.string(), kSources), registry_, cancel);
  ASSERT_TRUE(survey) << survey.error().message;
  ASSERT_EQ(survey->failures.size(), 1U);
  EXPECT_THAT(survey->failures.front(), HasSubstr("frame 1: "));
}

TEST_F(Evidence, ASurveyTakesTheSourceOfAPipelineFile) {
  std::ofstream(path("trials.yaml")) << "source: {use: sources/match_trials, params: {trials: 3, "
                                        "matches: 20}}\n";
  const std::atomic<bool> cancel{false};
  const auto survey =
      survey_data(*find_data_layout(path("trials.yaml"), kSources), registry_, cancel);
  ASSERT_TRUE(survey) << survey.error().message;
  EXPECT_EQ(survey->matches, 60);
  EXPECT_EQ(survey->grey + survey->colour, 0);
  EXPECT_EQ(survey->truth.at("match_trials").has.at("match_xy_px"), 3);
}

TEST_F(Evidence, ALayoutThatIsNotThereSaysWhatWasLookedFor) {
  EXPECT_THAT(find_data_layout(path("none"), kSources).error().message,
              HasSubstr("there is no such file or folder"));
  EXPECT_THAT(find_data_layout(folder_.string(), kSources).error().message, HasSubstr("no images"));
  write_frame({640, 480}, 800.0, 0.5);
  fs::remove(folder_ / "camera.yaml");
  EXPECT_THAT(find_data_layout(folder_.string(), kSources).error().message, HasSubstr("--camera"));
  std::ofstream(path("empty.yaml")) << "weft: 1\n";
  EXPECT_THAT(find_data_layout(path("empty.yaml"), kSources).error().message,
              HasSubstr("no source"));
}

}  // namespace
}  // namespace weft
