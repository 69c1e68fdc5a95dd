// SPDX-License-Identifier: Apache-2.0
#include "sheet_view.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <string>

#include "photo_folder.hpp"

namespace weft::photo {
namespace {

using ::testing::HasSubstr;

Still tilted_still() {
  Still still;
  still.camera = make_camera(1000, 750, false);
  still.tilt_rad = 0.6;
  still.turn_rad = 0.3;
  return still;
}

TEST(ViewOfSheet, MeasuresTheShapeOfARectangleAndHowItIsTilted) {
  const Still still = tilted_still();
  const Camera& c = still.camera.camera;
  const SheetView view = view_of_sheet(true_corners(still), {c.fx, c.fy, c.cx, c.cy});
  EXPECT_NEAR(view.height_over_width, 0.21 / 0.297, 1e-12);
  EXPECT_NEAR(view.skew_rad, 0.0, 1e-12);
  EXPECT_NEAR(std::cos(view.tilt_rad), std::cos(0.6) * std::cos(0.3), 1e-12);
  const Eigen::Vector3d corner = view.px_from_unit * Eigen::Vector3d(1.0, 1.0, 1.0);
  EXPECT_LT((corner.head<2>() / corner.z() - true_corners(still)[2]).norm(), 1e-9);
}

TEST(ViewOfSheet, TellsAWrongFocalLengthByAnglesThatAreNotRight) {
  const Still still = tilted_still();
  const Camera& c = still.camera.camera;
  const SheetView view = view_of_sheet(true_corners(still), {2 * c.fx, 2 * c.fy, c.cx, c.cy});
  EXPECT_GT(std::abs(view.skew_rad), 0.03);
}

TEST(GuessFocalLength, FollowsTheRightAnglesOfATiltedSheetAndThePriorOfOneFromAbove) {
  Still still = tilted_still();
  const Pinhole start{800.0, 800.0, 509.5, 367.0};  // the camera has 860 px
  const FocalGuess tilted = guess_focal_length(true_corners(still), start);
  EXPECT_NEAR(tilted.focal_px, 860.0, 25.0);
  EXPECT_LT(tilted.ratio_error, 0.01);
  still.tilt_rad = still.turn_rad = 0.0;
  const FocalGuess above = guess_focal_length(true_corners(still), start);
  EXPECT_NEAR(above.focal_px, 800.0, 40.0);
  EXPECT_LT(above.ratio_error, 0.003);
}

std::string mistake_of(const Corners& corners_px) {
  const auto legal = check_corners(corners_px);
  return legal ? "none" : legal.error().message;
}

TEST(CheckCorners, SaysWhatIsWrongWithThem) {
  const Eigen::Vector2d a(10, 10), b(110, 12), c(108, 90), d(9, 88);
  EXPECT_EQ(mistake_of({a, b, c, d}), "none");
  EXPECT_EQ(mistake_of({c, d, a, b}), "none");
  EXPECT_THAT(mistake_of({a, d, c, b}), HasSubstr("anticlockwise"));
  EXPECT_THAT(mistake_of({a, b, d, c}), HasSubstr("two sides cross"));
  EXPECT_THAT(mistake_of({a, b, {40, 30}, d}), HasSubstr("not convex at the bottom right corner"));
  EXPECT_THAT(mistake_of({a, b, {60, 50}, {11, 87}}), HasSubstr("on a line"));
  EXPECT_THAT(mistake_of({a, b, b, d}), HasSubstr("closer than 16 px"));
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_NE(mistake_of({a, {kInfinity, 12}, c, d}), "none");
  EXPECT_NE(mistake_of({a, {std::nan(""), 12}, c, d}), "none");
}

}  // namespace
}  // namespace weft::photo
