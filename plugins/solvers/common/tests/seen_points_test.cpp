// SPDX-License-Identifier: Apache-2.0
#include "common/seen/seen_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/least_bending.hpp"

namespace weft::solvers {
namespace {

struct Scene {
  Template templ = testing::make_template();
  Camera camera = testing::make_camera();
  Points3 truth_m = testing::bent_vertices(templ, testing::make_cylinder({}, 0.2, 0.3));
  Correspondences matches;

  explicit Scene(int count = 80) {
    Rng rng(31);
    matches = testing::draw_matches(templ, camera, truth_m, {.count = count}, rng).matches;
  }
};

TEST(SeenPoints, TheTrueVerticesSolveTheLinearSystem) {
  const Scene scene;
  const auto points = seen_points(scene.matches, scene.templ, 10);
  ASSERT_TRUE(points);
  EXPECT_EQ(points->size(), 80U);
  for (const SeenPoint& point : *points) {
    const auto rows = reprojection_rows(scene.camera, point.seen_px);
    EXPECT_LT((rows * point.on(scene.truth_m)).norm(), 1e-9);
  }
}

TEST(SeenPoints, TheSystemIsTheErrorInTheImageTimesTheDepth) {
  const Scene scene;
  const auto points = seen_points(scene.matches, scene.templ, 10);
  ASSERT_TRUE(points);
  const Points3 moved_m = scene.truth_m.rowwise() + Eigen::RowVector3d(0.01, -0.02, 0.05);
  const std::vector<double> errors_px = reprojection_errors_px(*points, scene.camera, moved_m);
  for (std::size_t i = 0; i < points->size(); ++i) {
    const Eigen::Vector3d at_m = (*points)[i].on(moved_m);
    const auto rows = reprojection_rows(scene.camera, (*points)[i].seen_px);
    EXPECT_NEAR((rows * at_m).norm(), errors_px[i] * at_m.z(), 1e-9);
  }
  EXPECT_TRUE(std::isinf(reprojection_errors_px(*points, scene.camera, -moved_m).front()));
}

TEST(SeenPoints, AFrontalSheetIsAtItsFrontalDistance) {
  Scene scene;
  scene.truth_m = testing::bent_vertices(scene.templ, testing::make_cylinder({}, 1e9, 0.0));
  Rng rng(32);
  scene.matches = testing::draw_matches(scene.templ, scene.camera, scene.truth_m, {}, rng).matches;
  const auto points = seen_points(scene.matches, scene.templ, 10);
  ASSERT_TRUE(points);
  const auto rest_m = scene.templ.vertices_m.matrix<3>();
  EXPECT_NEAR(frontal_distance_m(*points, scene.camera, rest_m), 0.65, 1e-6);
  std::vector<SeenPoint> heap = *points;
  for (SeenPoint& point : heap) point.seen_px = {300.1, 200.3};
  EXPECT_TRUE(std::isinf(frontal_distance_m(heap, scene.camera, rest_m)));
}

TEST(SeenPoints, ThoseWithinARadiusAreTheOnesThatFit) {
  Scene scene;
  scene.matches.image_px(4, 0) += 15.0;
  scene.matches.image_px(9, 1) -= 30.0;
  const auto points = seen_points(scene.matches, scene.templ, 10);
  ASSERT_TRUE(points);
  EXPECT_EQ(points_within(*points, scene.camera, scene.truth_m, 20.0).size(), 79U);
  EXPECT_EQ(points_within(*points, scene.camera, scene.truth_m, 10.0).size(), 78U);
}

TEST(SeenPoints, LeavesOutRejectedMatchesAndThoseBeyondTheMesh) {
  Scene scene;
  scene.matches.kept(3) = 0;
  scene.matches.face(5) = -1;
  const auto points = seen_points(scene.matches, scene.templ, 10);
  ASSERT_TRUE(points);
  EXPECT_EQ(points->size(), 78U);
}

TEST(SeenPoints, SaysWhatIsWrongWithMatches) {
  Scene scene;
  EXPECT_EQ(seen_points(scene.matches, scene.templ, 81).error().code, Errc::no_result);
  scene.matches.image_px(7, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(seen_points(scene.matches, scene.templ, 10).error().message,
            "match 7 is not finite: leave it out");
  scene.matches.face(2) = 90;
  EXPECT_EQ(seen_points(scene.matches, scene.templ, 10).error().message,
            "match 2 lies in face 90 of a template with 90: use one template throughout");
  Scene line;
  for (std::int64_t i = 0; i < line.matches.count(); ++i) {  // along an edge of the first face
    line.matches.face(i) = 0;
    const double along = static_cast<double>(i) / 80.0;
    line.matches.barycentrics.matrix<3>().row(i) << 1.0 - along, along, 0.0;
  }
  EXPECT_EQ(seen_points(line.matches, line.templ, 10).error().message,
            "the matches lie on a line of the template");
}

TEST(LeastBending, ContinuesAPlaneExactlyAndKeepsFixedVertices) {
  const Template templ = testing::make_template();
  const auto rest_m = templ.vertices_m.matrix<3>();
  const auto faces = templ.faces.matrix<3>();
  const auto topology = build_topology(faces, rest_m.rows());
  ASSERT_TRUE(topology);
  const auto hinges = bending_hinges(rest_m, faces, *topology);
  const double edge_m = mean_edge_length(rest_m, topology->edges);
  const Points3 plane_m =
      testing::bent_vertices(templ, testing::make_cylinder({}, 1e9, 0.0, {.tilt_y_rad = 0.5}));
  std::vector<std::uint8_t> fixed(60, 1);
  Points3 torn_m = plane_m;
  for (const Eigen::Index v : {0, 9, 25, 26, 59}) {
    fixed[static_cast<std::size_t>(v)] = 0;
    torn_m.row(v) *= 1.5;
  }
  const auto filled = fill_with_least_bending(rest_m, hinges, edge_m, fixed, torn_m);
  ASSERT_TRUE(filled);
  EXPECT_LT((*filled - plane_m).cwiseAbs().maxCoeff(), 1e-7);
  for (std::size_t v = 2; v < fixed.size(); ++v) fixed[v] = 0;
  EXPECT_EQ(fill_with_least_bending(rest_m, hinges, edge_m, fixed, torn_m).error().code,
            Errc::no_result);
}

}  // namespace
}  // namespace weft::solvers
