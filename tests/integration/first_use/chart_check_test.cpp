// SPDX-License-Identifier: Apache-2.0
// `weft template check` on a texture of two charts. The image shows one of them or both.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::testing::chart_check {
namespace {

using ::testing::HasSubstr;

const std::string kPipelines = WEFT_PIPELINES;
constexpr int kGap_px = 20;  // between the charts in the texture

/// The flat surface of the demo, cut in the middle into two charts with their own vertices.
std::string cut_sheet() {
  constexpr int kColumns = 15, kRows = 21;
  constexpr double kWidth_px = 842.0, kHeight_px = 595.0, kWidth_m = 0.297;
  std::ostringstream text;
  text.precision(15);
  for (const int chart : {0, 1}) {
    for (int j = 0; j < kRows; ++j) {
      for (int i = 0; i < kColumns; ++i) {
        const double s = 0.5 * (chart + i / (kColumns - 1.0)), t = j / (kRows - 1.0);
        text << "v " << kWidth_m * s << " " << kWidth_m * kHeight_px / kWidth_px * t << " 0\nvt "
             << (kWidth_px * s + kGap_px * chart) / (kWidth_px + kGap_px) << " " << 1.0 - t << "\n";
      }
    }
  }
  for (const int chart : {0, 1}) {
    const int first = chart * kColumns * kRows + 1;
    for (int j = 0; j + 1 < kRows; ++j) {
      for (int i = 0; i + 1 < kColumns; ++i) {
        text << "f";
        for (const int corner : {j * kColumns + i, (j + 1) * kColumns + i,
                                 (j + 1) * kColumns + i + 1, j * kColumns + i + 1}) {
          text << " " << first + corner << "/" << first + corner;
        }
        text << "\n";
      }
    }
  }
  return text.str();
}

class ChartCheck : public PipelineTest {
 protected:
  /// The answer of `weft template check` on a frame that shows the whole object.
  Ended check(const cv::Mat& texture) const {
    cv::imwrite(path("atlas.png"), texture);
    const std::string pipeline = write(
        "weft: 1\nextends: " + kPipelines +
            "/sparse.yaml\nwithout: [overlay, meshes]\nsource: {params: {frames: 1, bend_per_m: 0, "
            "tilt_rad: 0.2}}\ntemplate: {use: templates/mesh, params: {mesh: '" +
            write(cut_sheet(), "cut.obj") + "', texture: '" + path("atlas.png") + "'}}\n",
        "cut.yaml");
    return Child({WEFT_PROGRAM, "--plugin-path", WEFT_REAL_PLUGINS, "template", "check", pipeline,
                  "--set", "filters.use=filters/charts", "--json"},
                 path("said"))
        .wait();
  }

  /// The texture of the demo with a gap in its middle.
  static cv::Mat atlas() {
    const cv::Mat print = cv::imread(kPipelines + "/data/sheet_texture.png", cv::IMREAD_GRAYSCALE);
    cv::Mat texture(print.rows, print.cols + kGap_px, CV_8UC1, cv::Scalar(128));
    const int half = print.cols / 2;
    print.colRange(0, half).copyTo(texture.colRange(0, half));
    print.colRange(half, print.cols).copyTo(texture.colRange(half + kGap_px, texture.cols));
    return texture;
  }
};

TEST_F(ChartCheck, FindsNoFaultWhereTheImageShowsBothCharts) {
  const Ended checked = check(atlas());
  EXPECT_EQ(checked.exit_code, 0) << checked.out << checked.err;
  const auto json = nlohmann::json::parse(checked.out, nullptr, false);
  EXPECT_EQ(json.at("charts").at("judged").get<int>(), 2);
  EXPECT_EQ(json.at("charts").at("unmatched").get<int>(), 0);
}

TEST_F(ChartCheck, FailsWhereOneChartIsNotInTheImage) {
  cv::Mat texture = atlas();
  cv::Mat right = texture.colRange(texture.cols / 2 + kGap_px, texture.cols);
  cv::Mat other;
  cv::flip(right, other, 0);
  cv::Mat(255 - other).copyTo(right);  // mirrored and inverted: nothing of it is in the image
  const Ended checked = check(texture);
  EXPECT_EQ(checked.exit_code, 1) << checked.out << checked.err;
  const auto json = nlohmann::json::parse(checked.out, nullptr, false);
  EXPECT_EQ(json.at("charts").at("unmatched").get<int>(), 1);
  EXPECT_NEAR(json.at("charts").at("unmatched_share").get<double>(), 0.5, 0.05);
  EXPECT_THAT(json.at("faults").dump(), HasSubstr("% of the object gets no match: 1 of 2 charts"));
}

}  // namespace
}  // namespace weft::testing::chart_check
