// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/mesh_validation.hpp>

#include "common/plane_mesh.hpp"
#include "polygons.hpp"
#include "segmentation.hpp"

namespace weft::outline {
namespace {

using ::testing::HasSubstr;

/// A disc of an exact radius: pixels whose centres are within.
cv::Mat disc(double x, double y, double radius, int size = 400) {
  cv::Mat mask = cv::Mat::zeros(size, size, CV_8U);
  for (int j = 0; j < size; ++j) {
    for (int i = 0; i < size; ++i) {
      if (std::hypot(i - x, j - y) <= radius) mask.at<std::uint8_t>(j, i) = 1;
    }
  }
  return mask;
}

double mesh_area_px2(const PlaneMesh& mesh) {
  double area = 0.0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    area -= signed_area_px2(mesh.flat_px, mesh.faces, f);
  }
  return area;
}

double least_angle_deg(const PlaneMesh& mesh) {
  double least = M_PI;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d corner = mesh.flat_px.row(mesh.faces(f, k));
      const Eigen::Vector2d a = mesh.flat_px.row(mesh.faces(f, (k + 1) % 3)).transpose() - corner;
      const Eigen::Vector2d b = mesh.flat_px.row(mesh.faces(f, (k + 2) % 3)).transpose() - corner;
      least = std::min(least, std::acos(a.normalized().dot(b.normalized())));
    }
  }
  return least * 180.0 / M_PI;
}

/// Vertices - edges + faces: 1 for a disc, less one for each hole.
Eigen::Index euler(const PlaneMesh& mesh) {
  const auto topology = build_topology(mesh.faces, mesh.flat_px.rows());
  return mesh.flat_px.rows() - topology->edges.rows() + mesh.faces.rows();
}

PlaneMesh filled(const cv::Mat& mask, double spacing_px) {
  const auto mesh = fill_outline(resampled(trace_outline(mask), spacing_px), spacing_px, 10);
  if (!mesh) throw std::runtime_error(mesh.error().message);
  return *mesh;
}

TEST(TraceOutline, FollowsADiscWithinATenthOfAPixelOnAverage) {
  const Outline outline = trace_outline(disc(203.3, 197.8, 150.0));
  EXPECT_TRUE(outline.holes.empty());
  EXPECT_NEAR(std::sqrt(outline.area_px2() / M_PI), 150.0, 0.1);
  for (const Eigen::Vector2d& corner : outline.outer) {
    EXPECT_NEAR((corner - Eigen::Vector2d(203.3, 197.8)).norm(), 150.0, 0.75);
  }
}

TEST(TraceOutline, ReachesTheBorderOfAPictureThatTheObjectFills) {
  const Outline outline = trace_outline(cv::Mat::ones(60, 80, CV_8U));
  EXPECT_NEAR(outline.area_px2(), 60.0 * 80.0, 60.0);
}

TEST(Resampled, KeepsSharpCornersAndSpacesTheRestEqually) {
  Outline square;
  square.outer = {{10.0, 10.0}, {110.0, 10.0}, {110.0, 110.0}, {10.0, 110.0}};
  const Polygon points = resampled(square, 24.0).outer;
  ASSERT_EQ(points.size(), 16U);
  for (const Eigen::Vector2d& corner : square.outer) {
    EXPECT_NE(std::find(points.begin(), points.end(), corner), points.end());
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR((points[(i + 1) % 16] - points[i]).norm(), 25.0, 1e-9);
  }
}

TEST(Resampled, HasThreeCornersForAnyRequestedDistance) {
  const Outline outline = resampled(trace_outline(disc(200.0, 200.0, 20.0)), 1000.0);
  EXPECT_EQ(outline.outer.size(), 3U);
  EXPECT_GT(outline.area_px2(), 0.0);
}

TEST(FillOutline, OfADiscHasItsAreaGoodAnglesAndTheSpacingAskedFor) {
  for (const double spacing_px : {15.0, 30.0}) {
    const PlaneMesh mesh = filled(disc(200.0, 200.0, 150.0), spacing_px);
    EXPECT_NEAR(mesh_area_px2(mesh) / (M_PI * 150.0 * 150.0), 1.0, 0.01) << spacing_px;
    EXPECT_GT(least_angle_deg(mesh), 20.0) << spacing_px;
    EXPECT_EQ(euler(mesh), 1) << spacing_px;
    EXPECT_TRUE(validate_flat_mesh(mesh.flat_px, mesh.faces));
    const auto topology = build_topology(mesh.faces, mesh.flat_px.rows());
    EXPECT_NEAR(mean_edge_length(mesh.flat_px, topology->edges) / spacing_px, 1.0, 0.15);
  }
}

TEST(FillOutline, KeepsHoles) {
  cv::Mat mask = disc(200.0, 200.0, 150.0);
  mask.setTo(0, disc(150.0, 180.0, 30.0));
  mask.setTo(0, disc(270.0, 220.0, 40.0));
  const PlaneMesh mesh = filled(mask, 15.0);
  EXPECT_EQ(euler(mesh), -1);
  const double area = M_PI * (150.0 * 150.0 - 30.0 * 30.0 - 40.0 * 40.0);
  EXPECT_NEAR(mesh_area_px2(mesh) / area, 1.0, 0.01);
  EXPECT_GT(least_angle_deg(mesh), 20.0);
}

TEST(FillOutline, RefusesAnOutlineThatCrossesItself) {
  Outline bow;
  bow.outer = {{0.0, 0.0}, {100.0, 100.0}, {100.0, 0.0}, {0.0, 100.0}};
  const auto mesh = fill_outline(bow, 20.0, 0);
  ASSERT_FALSE(mesh);
  EXPECT_THAT(mesh.error().message, HasSubstr("crosses itself"));
}

TEST(ForegroundOf, FindsADarkAndAColouredObjectOnALightTable) {
  const cv::Mat truth = disc(200.0, 190.0, 120.0);
  for (const cv::Scalar& colour : {cv::Scalar(40, 40, 40), cv::Scalar(200, 200, 255)}) {
    cv::Mat photo(400, 400, CV_8UC3, cv::Scalar(235, 240, 238));
    photo.setTo(colour, truth);
    const auto mask = foreground_of(photo, 0.0);
    ASSERT_TRUE(mask) << mask.error().message;
    EXPECT_LT(cv::countNonZero(*mask != truth), 0.02 * cv::countNonZero(truth));
  }
}

TEST(ForegroundOf, RefusesAPhotographOfTheTableAlone) {
  cv::Mat photo(200, 300, CV_8UC3, cv::Scalar(235, 240, 238));
  for (int i = 0; i < 300; ++i) photo.at<cv::Vec3b>(100, i) = {237, 242, 240};
  const auto mask = foreground_of(photo, 0.0);
  ASSERT_FALSE(mask);
  EXPECT_THAT(mask.error().message, HasSubstr("no object stands out"));
  EXPECT_FALSE(foreground_of(cv::Mat::zeros(2, 2, CV_8UC1), 0.0));
}

TEST(SingleObject, KeepsTheLargestPartAndFillsSmallHoles) {
  cv::Mat mask = disc(150.0, 150.0, 100.0);
  mask.setTo(0, disc(120.0, 150.0, 4.0));
  mask.setTo(0, disc(180.0, 150.0, 25.0));
  mask.setTo(1, disc(340.0, 340.0, 30.0));
  const auto object = single_object(mask, 0.01);
  ASSERT_TRUE(object);
  EXPECT_EQ(object->at<std::uint8_t>(150, 120), 1);
  EXPECT_EQ(object->at<std::uint8_t>(150, 180), 0);
  EXPECT_EQ(object->at<std::uint8_t>(340, 340), 0);
  EXPECT_FALSE(touches_border(*object));
  EXPECT_TRUE(touches_border(cv::Mat::ones(10, 10, CV_8U)));
  EXPECT_FALSE(single_object(cv::Mat::zeros(50, 50, CV_8U), 0.01));
}

}  // namespace
}  // namespace weft::outline
