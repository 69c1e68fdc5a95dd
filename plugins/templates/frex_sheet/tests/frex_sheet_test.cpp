// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <memory>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <weft/core/index.hpp>
#include <weft/data/template.hpp>
#include <weft/generators/marker_sheet.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace {

using ::testing::HasSubstr;
using weft::MarkerSheetSpec;
using weft::Template;
using weft::testing::PluginUnderTest;

class FrexSheet : public ::testing::Test {
 protected:
  Template built(const std::string& params) {
    plugin_ = std::make_unique<PluginUnderTest>("templates/frex_sheet", params);
    const auto outcome = plugin_->process(0, {});
    EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
    auto templ = outcome.get<Template>();
    if (!templ) throw std::runtime_error("no template");
    return *std::move(templ);
  }

  static cv::Mat picture(const Template& templ) {
    return cv::Mat(static_cast<int>(templ.texture.dim(0)), static_cast<int>(templ.texture.dim(1)),
                   CV_8U, const_cast<std::uint8_t*>(templ.texture.data()))
        .clone();
  }

  std::unique_ptr<PluginUnderTest> plugin_;  // the template lives in it
};

TEST_F(FrexSheet, ShowsEachMarkerWhereTheLayoutSays) {
  for (const std::string dictionary : {"5x5_250", "4x4_250"}) {
    const Template templ =
        built("{px_per_mm: 5, seed: 4, count: 60, dictionary: " + dictionary + "}");
    MarkerSheetSpec spec;
    spec.seed = 4;
    spec.count = 60;
    const auto sheet = weft::lay_out_markers(spec);
    ASSERT_TRUE(sheet);
    std::vector<std::vector<cv::Point2f>> corners;
    std::vector<int> ids;
    cv::aruco::detectMarkers(
        picture(templ),
        cv::aruco::getPredefinedDictionary(dictionary == "4x4_250" ? cv::aruco::DICT_4X4_250
                                                                   : cv::aruco::DICT_5X5_250),
        corners, ids);
    ASSERT_EQ(ids.size(), 60U) << dictionary;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const weft::SheetMarker& marker = sheet->markers[weft::to_index(ids[i])];
      for (int k = 0; k < 4; ++k) {
        const cv::Point2f& found = corners[i][weft::to_index(k)];
        const Eigen::Vector2d edge_px = 5.0 * marker.corners_mm.row(k).transpose();
        EXPECT_NEAR(found.x + 0.5, edge_px.x(), 1.01);
        EXPECT_NEAR(found.y + 0.5, edge_px.y(), 1.01);
      }
    }
  }
}

TEST_F(FrexSheet, HasTheExactPitchAndSpansThePaper) {
  const Template templ = built("{px_per_mm: 4, columns: 12, rows: 8}");
  EXPECT_EQ(templ.texture.dim(0), 840);
  EXPECT_EQ(templ.texture.dim(1), 1188);
  EXPECT_EQ(templ.m_per_px(0), 0.00025);
  EXPECT_EQ(templ.m_per_px(1), 0.00025);
  EXPECT_EQ(templ.vertices_m.rows(), 96);
  EXPECT_EQ(templ.faces.rows(), 2 * 11 * 7);
  EXPECT_NEAR(templ.vertices_m(95, 0) - templ.vertices_m(0, 0), 0.297, 1e-12);
  EXPECT_NEAR(templ.vertices_m(95, 1) - templ.vertices_m(0, 1), 0.210, 1e-12);
  EXPECT_DOUBLE_EQ(templ.flat_px(0, 0), -0.5);
  EXPECT_DOUBLE_EQ(templ.flat_px(95, 1), 839.5);
}

TEST_F(FrexSheet, IsBlackAndWhiteWhereModulesEndBetweenTexelsToo) {
  // A module of 14 mm / 6 is 9.33 texels of a quarter millimetre: its sides are grey.
  const cv::Mat coarse = picture(built("{px_per_mm: 4, dictionary: 4x4_250}"));
  const cv::Mat fine = picture(built("{px_per_mm: 12, dictionary: 4x4_250}"));
  cv::Mat mean;
  cv::resize(fine, mean, coarse.size(), 0.0, 0.0, cv::INTER_AREA);
  EXPECT_LE(cv::norm(coarse, mean, cv::NORM_INF), 1.0);
  EXPECT_GT(cv::countNonZero((coarse > 10) & (coarse < 245)), 1000);
}

TEST_F(FrexSheet, SaysWhyASheetIsImpossible) {
  const auto refusal = [](const std::string& params) {
    PluginUnderTest plugin("templates/frex_sheet", params);
    const auto outcome = plugin.process(0, {});
    EXPECT_EQ(outcome.status, WEFT_ERROR) << params;
    return outcome.message;
  };
  EXPECT_THAT(refusal("{count: 200}"), HasSubstr("do not fit"));
  EXPECT_THAT(refusal("{width_mm: 40}"), HasSubstr("do not fit"));
  EXPECT_THAT(refusal("{width_mm: 2000, height_mm: 2000, px_per_mm: 40}"),
              HasSubstr("'px_per_mm'"));
  EXPECT_THROW(PluginUnderTest("templates/frex_sheet", "{count: 0}"), std::runtime_error);
  EXPECT_THROW(PluginUnderTest("templates/frex_sheet", "{px_per_mm: 0}"), std::runtime_error);
  EXPECT_THROW(PluginUnderTest("templates/frex_sheet", "{dictionary: 6x6_250}"),
               std::runtime_error);
}

}  // namespace
