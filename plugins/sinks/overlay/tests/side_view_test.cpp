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

class SideViewRaster : public ::testing::Test {
 protected:
  /// Blue is u and green is v.
  SideViewRaster() {
    cv::Mat3b texture(100, 100);
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 100; ++x)
        texture(y, x) = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 200};
    }
    paint_ = Paint(texture, cv::Scalar::all(255), 2.0);
    raster_.clear({100, 100});
  }

  Paint paint_;
  Raster raster_;
};

TEST_F(SideViewRaster, ShowsTheNearerTriangleInWhateverOrder) {
  for (const bool near_first : {false, true}) {
    raster_.clear({100, 100});
    for (const bool is_near : {near_first, !near_first}) {
      Three corners = triangle(is_near ? 2.0 : 1.0);
      for (Corner& corner : corners) corner.light = is_near ? 0.25 : 0.75;
      raster_.draw(corners, {false, false, false}, paint_);
    }
    EXPECT_EQ(raster_.colour({30, 30})[2], 50);
    EXPECT_EQ(raster_.nearness({95, 95}), 0.0F);
  }
}

TEST_F(SideViewRaster, LaysTheTextureInPerspective) {
  // Along the upper side from 1 m to 3 m: half-way on the canvas is a quarter of the way in space.
  Three corners = triangle(1.0);
  corners[2].nearness = 1.0 / 3.0;
  raster_.draw(corners, {false, false, false}, paint_);
  EXPECT_EQ(raster_.colour({50, 10})[0], 30);
  EXPECT_EQ(raster_.colour({50, 10})[1], 10);
  EXPECT_NEAR(raster_.nearness({50, 10}), 2.0 / 3.0, 1e-5);
}

TEST_F(SideViewRaster, DrawsTheSidesThatAreLines) {
  raster_.draw(triangle(1.0), {false, true, false}, paint_);  // the upper side, in black
  EXPECT_LT(raster_.colour({40, 10})[2], 120);
  EXPECT_EQ(raster_.colour({10, 40})[2], 200);
  EXPECT_EQ(raster_.colour({40, 14})[2], 200);
}

TEST_F(SideViewRaster, LeavesNoGapBetweenTrianglesAndNothingBesideThem) {
  // A square of two triangles, of a width that is no multiple of a vector of pixels.
  Three one = triangle(1.0), other = triangle(1.0);
  other[0].at_px = {90, 90};
  std::swap(other[1], other[2]);
  raster_.draw(one, {false, false, false}, paint_);
  raster_.draw(other, {false, false, false}, paint_);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      const bool is_inside = x >= 10 && x <= 90 && y >= 10 && y <= 90;
      EXPECT_EQ(raster_.nearness({x, y}) > 0.0F, is_inside) << x << " " << y;
    }
  }
}

TEST_F(SideViewRaster, IsSmoothAtItsRim) {
  // The left side ends between two pixels of the raster, and so within one of the canvas.
  Three corners = triangle(1.0);
  corners[0].at_px.x = corners[1].at_px.x = 10.5;
  raster_.draw(corners, {false, false, false}, paint_);
  cv::Mat canvas(50, 50, CV_8UC3, cv::Scalar::all(100));
  raster_.lay_over<2>(canvas);
  EXPECT_EQ(canvas.at<cv::Vec3b>(10, 4)[2], 100);
  EXPECT_EQ(canvas.at<cv::Vec3b>(10, 5)[2], 150);
  EXPECT_EQ(canvas.at<cv::Vec3b>(10, 6)[2], 200);
}

TEST_F(SideViewRaster, LeavesOutWhatIsBeyondTheCanvasOrDegenerate) {
  Three far = triangle(1.0), flat = triangle(1.0);
  for (Corner& corner : far) corner.at_px += {1e12, -1e12};
  flat[2].at_px = flat[1].at_px;
  raster_.draw(far, {true, true, true}, paint_);
  raster_.draw(flat, {true, true, true}, paint_);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) EXPECT_EQ(raster_.nearness({x, y}), 0.0F);
  }
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
