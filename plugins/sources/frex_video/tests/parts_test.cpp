// SPDX-License-Identifier: Apache-2.0
// Markers that mislead and layouts that are wrong.
#include <gmock/gmock.h>

#include <iostream>

#include "filmed_sheet.hpp"
#include "layout_file.hpp"
#include "located_sheet.hpp"

namespace weft::frex_video {
namespace {

using testing::FilmedSheet;
using ::testing::HasSubstr;
using testing::PluginUnderTest;

constexpr double kPxPerMm = 820.0 / 600.0;

/// The paper seen flat and from the front at 0.6 m, and its layout.
class FrontalSheet : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    FilmedSheet filmed;
    PluginUnderTest film("sources/synthetic", filmed.film("sheet.png"));
    static_cast<void>(film.process(testing::kOpen, {}));
    const auto image = film.process(testing::kRead, {}, 0).get<Image>();
    grey_ = testing::view(image->pixels).clone();
  }

  static Eigen::Vector2d true_px(const Eigen::Vector2d& point_mm) {
    return Eigen::Vector2d(319.5, 239.5) + kPxPerMm * (point_mm - Eigen::Vector2d(148.5, 105.0));
  }
  /// The part of the image that shows a marker and the white around it.
  static cv::Rect place_of(const SheetMarker& marker) {
    const Eigen::Vector2d corner = true_px(marker.corners_mm.row(0).transpose());
    return {static_cast<int>(corner.x()) - 2, static_cast<int>(corner.y()) - 2, 24, 24};
  }
  static const SeenMarker* find(const std::vector<SeenMarker>& seen, std::size_t marker) {
    for (const SeenMarker& one : seen) {
      if (one.marker == marker) return &one;
    }
    return nullptr;
  }

  static cv::Mat grey_;
  const MarkerSheet sheet_ = *lay_out_markers({});
  const Pinhole camera_{820.0, 820.0, 319.5, 239.5};
};
cv::Mat FrontalSheet::grey_;

TEST_F(FrontalSheet, HasNearlyAllMarkersFoundWithinASixthOfAPixel) {
  const std::vector<SeenMarker> seen = MarkerFinder(sheet_).find(grey_);
  EXPECT_GE(seen.size(), 90U);
  double sum = 0.0, sum_of_corners = 0.0;
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  for (const SeenMarker& one : seen) {
    const SheetMarker& marker = sheet_.markers[one.marker];
    const Eigen::Vector2d error = one.centre_px - true_px(marker.centre_mm());
    EXPECT_LT(error.norm(), 0.5) << one.marker;
    sum += error.squaredNorm();
    shift += error;
    for (int k = 0; k < 4; ++k) {
      sum_of_corners +=
          (one.corners_px.row(k).transpose() - true_px(marker.corners_mm.row(k).transpose()))
              .squaredNorm();
    }
  }
  const auto count = static_cast<double>(seen.size());
  std::cout << seen.size() << " markers, rms of centres " << std::sqrt(sum / count)
            << " px, of corners " << std::sqrt(sum_of_corners / count / 4.0) << " px\n";
  EXPECT_LT(shift.norm() / count, 0.05) << "pixel centres are integers";
  EXPECT_LT(std::sqrt(sum / count), 1.0 / 6.0);
  EXPECT_LT(std::sqrt(sum_of_corners / count / 4.0), 0.3);
}

TEST_F(FrontalSheet, LosesMarkersThatAreSeenTwice) {
  const SheetMarker& marker = sheet_.markers[7];
  cv::Mat twice(grey_.rows, grey_.cols + 100, CV_8UC1, cv::Scalar(200));
  grey_.copyTo(twice(cv::Rect(0, 0, grey_.cols, grey_.rows)));
  grey_(place_of(marker)).copyTo(twice(cv::Rect(grey_.cols + 40, 100, 24, 24)));
  const MarkerFinder finder(sheet_);
  EXPECT_NE(find(finder.find(grey_), 7), nullptr);
  EXPECT_EQ(find(finder.find(twice), 7), nullptr);
}

TEST_F(FrontalSheet, LosesMarkersThatTheSheetDoesNotHave) {
  MarkerSheet fewer = sheet_;
  fewer.markers.resize(40);
  const MarkerFinder finder(fewer);
  for (const SeenMarker& one : finder.find(grey_)) EXPECT_LT(one.marker, 40U);
}

TEST_F(FrontalSheet, IsNotFoundInAMirror) {
  cv::Mat mirrored;
  cv::flip(grey_, mirrored, 1);
  const auto found = locate_sheet(MarkerFinder(sheet_), mirrored, camera_, {});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, Errc::no_result);
}

TEST_F(FrontalSheet, DropsMarkersThatAreElsewhereAndKeepsTheOthers) {
  MarkerSheet swapped = sheet_;
  std::swap(swapped.markers[3].corners_mm, swapped.markers[60].corners_mm);
  std::swap(swapped.markers[20].corners_mm, swapped.markers[21].corners_mm);
  const MarkerFinder finder(swapped);
  const std::vector<SeenMarker> seen = finder.find(grey_);
  const auto warp = fit_warp(swapped, seen, 30, 3.0);
  ASSERT_TRUE(warp) << warp.error().message;
  for (const std::size_t wrong : {3, 20, 21, 60}) EXPECT_EQ(find(warp->markers, wrong), nullptr);
  EXPECT_GE(warp->markers.size(), seen.size() - 6);
  EXPECT_LT(warp->leave_one_out_px, 0.3);
}

TEST_F(FrontalSheet, NeedsEnoughMarkersThatAgree) {
  cv::Mat covered = grey_.clone();
  covered.colRange(0, 420) = cv::Scalar(90);
  const auto found = locate_sheet(MarkerFinder(sheet_), covered, camera_, {});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, Errc::no_result);
  EXPECT_THAT(found.error().message, HasSubstr("30 are needed"));

  MarkerSheetSpec other;
  other.seed = 2;
  const auto strange = locate_sheet(MarkerFinder(*lay_out_markers(other)), grey_, camera_, {});
  ASSERT_FALSE(strange);
  EXPECT_EQ(strange.error().code, Errc::no_result);
}

TEST_F(FrontalSheet, IsKnownOnlyAroundTheMarkersThatAreSeen) {
  cv::Mat covered = grey_.clone();
  covered.colRange(0, 260) = cv::Scalar(90);
  const auto found = locate_sheet(MarkerFinder(sheet_), covered, camera_, {});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_FALSE(found->is_known({40.0, 105.0}));
  EXPECT_TRUE(found->is_known({200.0, 105.0}));
}

TEST(Layout, IsReadAsItWasWritten) {
  const testing::FrameFolder folder;
  const MarkerSheet sheet = *lay_out_markers({});
  folder.write("sheet.yaml", to_yaml(sheet));
  const auto read = read_layout_file(folder.path("sheet.yaml"));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(to_yaml(*read), to_yaml(sheet));
}

TEST(Layout, NamesThePlaceOfAMistake) {
  const testing::FrameFolder folder;
  const std::string head = "marker_sheet: 1\ndictionary: 5x5_250\nwidth_mm: 99\nheight_mm: 50\n";
  const std::string one = "id: 1, centre_mm: [5, 5], corners_mm: [[0, 0], [10, 0], [10, 10], ";
  const std::pair<std::string, std::string> cases[] = {
      {"a: [", ":"},
      {"[]", "must hold keys"},
      {"marker_sheet: 2", "marker_sheet: 1"},
      {"marker_sheet: 1\ndictionary: 6x6", ":2:13: 'dictionary'"},
      {head, "has no 'markers'"},
      {head + "markers: 3\n", ":5:10: 'markers' must be a list"},
      {head + "markers: []\nmarkers: []\n", "given twice"},
      {head + "markers: []\nscale: 2\n", "'scale' is unknown"},
      {head + "markers:\n  - {" + one + "[0, 10]]}\n  - {" + one + "[0, 10]]}\n", "id 1"},
      {head + "markers:\n  - {" + one + "[0, 60]]}\n", "outside the page"},
      {head + "markers:\n  - {" + one + "[0, nan]]}\n", "'corners_mm' must be a number"},
      {head + "markers:\n  - {" + one + "[20, 1]]}\n", "clockwise"},
      {head + "markers:\n  - {id: 1, centre_mm: [5, 6], corners_mm: [[0, 0], [10, 0], [10, 10], "
              "[0, 10]]}\n",
       "'centre_mm' is not"},
      {head + "markers:\n  - {id: 1.5, centre_mm: [5, 5], corners_mm: []}\n", "whole number"}};
  for (const auto& [text, message] : cases) {
    folder.write("sheet.yaml", text);
    const auto read = read_layout_file(folder.path("sheet.yaml"));
    ASSERT_FALSE(read) << text;
    EXPECT_THAT(read.error().message, HasSubstr("sheet.yaml:"));
    EXPECT_THAT(read.error().message, HasSubstr(message)) << text;
  }
  EXPECT_THAT(read_layout_file(folder.path("none.yaml")).error().message, HasSubstr("'layout'"));
}

}  // namespace
}  // namespace weft::frex_video
