// SPDX-License-Identifier: Apache-2.0
#include "sheet_finder.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "photo_folder.hpp"

namespace weft::photo {
namespace {

using ::testing::HasSubstr;

Photograph photograph_of(const Still& still) { return {photographed(still), still.camera, true}; }

double worst_corner_px(const Corners& found, const Corners& truth) {
  double worst = 0.0;
  for (std::size_t k = 0; k < 4; ++k) worst = std::max(worst, (found[k] - truth[k]).norm());
  return worst;
}

/// Corners within half a pixel, height / width within half a percent.
void expect_found(const Still& still, const char* what) {
  const Photograph photo = photograph_of(still);
  const auto found = find_sheet(photo);
  ASSERT_TRUE(found) << what << ": " << found.error().message;
  EXPECT_LT(worst_corner_px(found->corners_px, true_corners(still)), 0.5) << what;
  const SheetView view = view_of_sheet(found->corners_px, photo.pinhole());
  EXPECT_NEAR(view.height_over_width / (still.height_m / still.width_m), 1.0, 0.005) << what;
  EXPECT_LT(std::abs(view.skew_rad), 0.01) << what;
}

TEST(FindSheet, FindsTheCornersOfAMapOnATableThroughALens) {
  Still still = still_of(960, true);
  expect_found(still, "from straight above");
  still.tilt_rad = 0.5;
  still.roll_rad = 0.1;
  still.aside_m = {0.02, -0.01};
  expect_found(still, "from the front");
  still.table = Table::wood;
  still.turn_rad = -0.35;
  still.tilt_rad = 0.25;
  still.table_grey = 130.0;
  still.distance_m = 0.6;
  expect_found(still, "from the side, on planks");
}

TEST(FindSheet, FindsAPosterWithAWhiteMarginOnALightTable) {
  Still still = still_of(960, false);
  still.margin_m = 0.012;
  still.paper_grey = 244.0;
  still.table_grey = 225.0;
  still.tilt_rad = 0.3;
  expect_found(still, "paper of 244 on a table of 225 +- 6");
}

TEST(FindSheet, FindsASheetThatIsDarkerThanItsTable) {
  Still still = still_of(960, true);
  still.margin_m = 0.01;
  still.paper_grey = 60.0;
  still.table_grey = 200.0;
  still.roll_rad = -0.4;
  still.distance_m = 0.6;
  expect_found(still, "black paper");
}

/// A hand over the middle of a side: it hides this share of the side, and reaches inwards.
void hold(cv::Mat& photo, const Eigen::Vector2d& from_px, const Eigen::Vector2d& to_px,
          double share) {
  constexpr int kFingers = 4;
  const Eigen::Vector2d side = to_px - from_px, inwards(-side.y(), side.x());
  const auto pixel = [](const Eigen::Vector2d& at) {
    return cv::Point(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
  };
  const int thickness = static_cast<int>(share * side.norm() / kFingers) + 1;
  for (int k = 0; k < kFingers; ++k) {
    const double along = 0.5 + share * ((k + 0.5) / kFingers - 0.5);
    const Eigen::Vector2d knuckle = from_px + along * side;
    const double length = 0.12 + 0.03 * (k % 2);
    cv::line(photo, pixel(knuckle - 0.5 * inwards), pixel(knuckle + length * inwards),
             cv::Scalar(120 + 5 * k, 150 + 5 * k, 195 + 5 * k), thickness, cv::LINE_AA);
  }
}

TEST(FindSheet, FindsASheetInTwoHands) {
  Still still = still_of(640, false);
  still.tilt_rad = 0.2;
  still.roll_rad = 0.12;
  for (const double share : {0.4, 0.6}) {
    Photograph photo = photograph_of(still);
    const Corners truth = true_corners(still);
    hold(photo.pixels, truth[1], truth[2], share);
    hold(photo.pixels, truth[3], truth[0], share);
    auto found = find_sheet(photo);
    if (!found) found = find_sheet(photo, Missing::to_hands);
    ASSERT_TRUE(found) << share << ": " << found.error().message;
    EXPECT_FALSE(found->border_side);
    EXPECT_LT(worst_corner_px(found->corners_px, truth), 0.8) << share;
  }
}

/// Moved so that the right side of the surface lies `beyond_px` to the right of the photograph's.
Still at_the_border(double beyond_px) {
  Still still = still_of(640, false);
  const Camera& camera = still.camera.camera;
  const double side_px = static_cast<double>(camera.width_px) - 0.5 + beyond_px;
  still.aside_m.x() = (side_px - camera.cx) * still.distance_m / camera.fx - 0.5 * still.width_m;
  return still;
}

TEST(FindSheet, FindsASheetOfWhichOneSideIsTheBorderOfThePhotograph) {
  for (const double beyond_px : {0.0, 30.0}) {
    const Still still = at_the_border(beyond_px);
    Corners seen = true_corners(still);
    seen[1].x() = seen[2].x() = static_cast<double>(still.camera.camera.width_px) - 1.0;
    const Photograph photo = photograph_of(still);
    const auto found = find_sheet(photo, Missing::one_side);
    ASSERT_TRUE(found) << beyond_px << ": " << found.error().message;
    EXPECT_EQ(found->border_side, 1U) << "the right side";
    EXPECT_LT(worst_corner_px(found->corners_px, seen), 1.0) << beyond_px;
  }
}

TEST(FindSheet, TakesNoSheetForWholeThatIsCutOffAslant) {
  Still still = at_the_border(40.0);
  still.roll_rad = 0.25;
  for (const Missing missing : {Missing::little, Missing::to_hands, Missing::one_side}) {
    EXPECT_FALSE(find_sheet(photograph_of(still), missing));
  }
}

TEST(FindSheet, SaysWhatToDoWhereThereIsNoSheet) {
  Still still = still_of(640, false);
  still.aside_m = {5.0, 5.0};
  for (const Table table : {Table::plain, Table::wood}) {
    still.table = table;
    const Photograph photo = photograph_of(still);
    const auto found = find_sheet(photo);
    ASSERT_FALSE(found);
    EXPECT_THAT(found.error().message, HasSubstr("no object is found"));
    EXPECT_THAT(found.error().message, HasSubstr("give 'corners'"));
    EXPECT_FALSE(find_sheet(photo, Missing::to_hands));
    EXPECT_FALSE(find_sheet(photo, Missing::one_side));
  }
}

TEST(FindSheet, SaysThatASheetIsCutOffByTheBorder) {
  Still still = still_of(640, false);
  still.print = cv::Mat(60, 84, CV_8UC3, cv::Scalar(230, 240, 235));
  still.aside_m = {0.16, 0.0};
  const auto found = find_sheet(photograph_of(still));
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().message, HasSubstr("cut off by the border"));
}

TEST(Upright, BeginsWithTheCornerThatIsTheTopLeftOfTheReader) {
  const Corners upright_sheet{Eigen::Vector2d(10, 12), {200, 20}, {190, 150}, {5, 140}};
  Corners turned = upright_sheet;
  for (int turn = 0; turn < 4; ++turn) {
    EXPECT_TRUE(upright(turned) == upright_sheet) << turn;
    std::rotate(turned.begin(), turned.begin() + 1, turned.end());
  }
}

}  // namespace
}  // namespace weft::photo
