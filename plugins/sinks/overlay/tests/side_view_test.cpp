// SPDX-License-Identifier: Apache-2.0
#include "side_view.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <weft/data/matrix.hpp>
#include <weft/testing/synthetic.hpp>

#include "drawing.hpp"
#include "floor.hpp"

namespace weft::overlay {
namespace {

using Three = std::array<Corner, 3>;

/// A right angle at (10,10) with sides of 80 px; texture coordinates are those of the canvas.
Three triangle(double nearness) {
  Three corners;
  const cv::Point2d places[] = {{10, 10}, {10, 90}, {90, 10}};
  for (std::size_t k = 0; k < 3; ++k) corners[k] = {places[k], nearness, places[k], 1.0, 0.0};
  return corners;
}

TEST(SideViewRaster, ShowsTheNearerTriangleInWhateverOrder) {
  for (const bool near_first : {false, true}) {
    Raster raster({100, 100});
    for (const bool is_near : {near_first, !near_first}) {
      Three corners = triangle(is_near ? 2.0 : 1.0);
      for (Corner& corner : corners) corner.light = is_near ? 0.25 : 0.75;
      draw_triangle(raster, corners, {false, false, false}, 1.0);
    }
    EXPECT_FLOAT_EQ(raster.light(30, 30), 0.25F);
    EXPECT_EQ(raster.nearness(95, 95), 0.0F);
  }
}

TEST(SideViewRaster, LaysTheTextureInPerspective) {
  // Along the upper side from 1 m to 3 m: half-way on the canvas is a quarter of the way in space.
  Three corners = triangle(1.0);
  corners[2].nearness = 1.0 / 3.0;
  Raster raster({100, 100});
  draw_triangle(raster, corners, {false, false, false}, 1.0);
  EXPECT_NEAR(raster.uv_px(10, 50)[0], 10.0 + 0.25 * 80.0, 1e-3);
  EXPECT_NEAR(raster.nearness(10, 50), 2.0 / 3.0, 1e-5);
}

TEST(SideViewRaster, DrawsTheSidesThatAreLines) {
  Raster raster({100, 100});
  draw_triangle(raster, triangle(1.0), {false, true, false}, 2.0);  // the upper side
  EXPECT_FLOAT_EQ(raster.line(10, 40), 1.0F);
  EXPECT_FLOAT_EQ(raster.line(40, 10), 0.0F);
  EXPECT_FLOAT_EQ(raster.line(14, 40), 0.0F);
}

TEST(SideViewRaster, LeavesOutWhatIsBeyondTheCanvasOrDegenerate) {
  Raster raster({100, 100});
  Three far = triangle(1.0), flat = triangle(1.0);
  for (Corner& corner : far) corner.at_px += {1e12, -1e12};
  flat[2].at_px = flat[1].at_px;
  draw_triangle(raster, far, {true, true, true}, 1.0);
  draw_triangle(raster, flat, {true, true, true}, 1.0);
  EXPECT_EQ(cv::countNonZero(raster.nearness), 0);
}

TEST(Orbit, HoldsTheMiddleStillAndAllOfTheBallInThePicture) {
  const Eigen::Vector3d middle(0.1, -0.2, 0.7);
  constexpr double kRadius_m = 0.18;
  const cv::Size size(300, 200);
  const Orbit first(middle, kRadius_m, size, 0, 90);
  for (std::uint64_t frame = 0; frame < 90; frame += 7) {
    const Orbit orbit(middle, kRadius_m, size, frame, 90);
    EXPECT_LT(cv::norm(orbit.project(orbit.moved(middle)) - first.project(first.moved(middle))),
              1e-9);
    for (int k = 0; k < 24; ++k) {
      const double angle_rad = 2.0 * std::numbers::pi * k / 24;
      const Eigen::Vector3d rim =
          middle + kRadius_m * Eigen::Vector3d(std::cos(angle_rad), std::sin(angle_rad), 0.0);
      const cv::Point2d at_px = orbit.project(orbit.moved(rim));
      EXPECT_TRUE(at_px.x > -1 && at_px.x < 300 && at_px.y > -1 && at_px.y < 200) << at_px;
    }
  }
}

TEST(Orbit, LooksFromTheSideSoThatDepthIsSeen) {
  // A point behind the middle moves to the side and, as the camera looks down, up.
  const Orbit orbit({0, 0, 1}, 0.2, {200, 200}, 30, 0);
  const cv::Point2d middle = orbit.project(orbit.moved({0, 0, 1}));
  const cv::Point2d behind = orbit.project(orbit.moved({0, 0, 1.15}));
  EXPECT_GT(std::abs(behind.x - middle.x), 15.0);
  EXPECT_LT(behind.y, middle.y - 10.0);
}

TEST(DrawnEdges, AreAllButThoseThatHalveARectangle) {
  Template sheet = testing::make_template({3, 2, 0.2, 0.1, 20, 10});
  const auto lines = [&] {
    const auto topology = build_topology(sheet.faces.matrix<3>(), sheet.vertices_m.rows());
    const auto drawn = drawn_edges(sheet.vertices_m.matrix<3>(), *topology);
    return std::count(drawn.begin(), drawn.end(), 1);
  };
  EXPECT_EQ(lines(), 7);  // edges of two cells; 9 with their diagonals
  for (std::int64_t v = 0; v < 3; ++v) sheet.vertices_m(v, 0) += 0.01;  // the upper row
  EXPECT_EQ(lines(), 9);
}

TEST(Floor, HasLinesAtRoundLengths) {
  EXPECT_DOUBLE_EQ(floor_step_m(0.18), 0.05);
  EXPECT_DOUBLE_EQ(floor_step_m(0.29), 0.05);
  EXPECT_DOUBLE_EQ(floor_step_m(0.35), 0.1);
  EXPECT_DOUBLE_EQ(floor_step_m(9.0), 2.0);
  EXPECT_EQ(length_text(0.05), "5 cm");
  EXPECT_EQ(length_text(0.002), "2 mm");
  EXPECT_EQ(length_text(2.0), "2 m");
}

}  // namespace
}  // namespace weft::overlay
