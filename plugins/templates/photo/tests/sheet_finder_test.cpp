// SPDX-License-Identifier: Apache-2.0
#include "sheet_finder.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

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
  EXPECT_LT(worst_corner_px(*found, true_corners(still)), 0.5) << what;
  const SheetView view = view_of_sheet(*found, photo.pinhole());
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

TEST(FindSheet, SaysWhatToDoWhereThereIsNoSheet) {
  Still still = still_of(640, false);
  still.aside_m = {5.0, 5.0};
  for (const Table table : {Table::plain, Table::wood}) {
    still.table = table;
    const auto found = find_sheet(photograph_of(still));
    ASSERT_FALSE(found);
    EXPECT_THAT(found.error().message, HasSubstr("no sheet is found"));
    EXPECT_THAT(found.error().message, HasSubstr("give 'corners'"));
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
