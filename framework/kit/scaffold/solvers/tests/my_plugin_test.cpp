// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/sightlines.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace {

using namespace weft::testing;

/// Vertices of the undeformed surface in a pose.
weft::Points3 placed(const weft::Template& templ, const PoseSpec& pose) {
  const Eigen::Isometry3d camera_from_template = make_pose({}, pose);
  return (templ.vertices_m.matrix<3>() * camera_from_template.linear().transpose()).rowwise() +
         camera_from_template.translation().transpose();
}

/// A sightline of each vertex, in the first face that has it.
weft::Sightlines sightlines_to(const weft::Template& templ, const weft::Points3& vertices_m) {
  const std::int64_t count = vertices_m.rows();
  const weft::Pinhole camera = pinhole(make_camera());
  weft::Sightlines lines;
  lines.vertex = weft::Array<std::int32_t>({count});
  lines.face = weft::Array<std::int32_t>({count}, 0);
  lines.barycentrics = weft::Array<double>({count, 3}, 0.0);
  lines.pixel_px = weft::make_array<double>(weft::project_points(camera, vertices_m));
  lines.ray = weft::make_array<double>(weft::unit_rays(camera, lines.pixel_px.matrix<2>()));
  lines.weight = weft::Array<double>({count}, 1.0);
  lines.coverage = 1.0;
  for (std::int64_t v = 0; v < count; ++v) lines.vertex(v) = static_cast<std::int32_t>(v);
  for (std::int64_t f = templ.faces.rows() - 1; f >= 0; --f) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t vertex = templ.faces(f, k);
      lines.face(vertex) = static_cast<std::int32_t>(f);
      for (int c = 0; c < 3; ++c) lines.barycentrics(vertex, c) = c == k ? 1.0 : 0.0;
    }
  }
  return lines;
}

TEST(MyPluginSolver, FindsThePoseOfARigidSheet) {
  const weft::Template templ = make_template();
  const PoseSpec poses[] = {{},
                            {.distance_m = 0.6, .x_m = 0.05, .tilt_x_rad = 0.4},
                            {.tilt_x_rad = -0.3, .tilt_y_rad = 0.5, .roll_rad = 2.0}};
  for (const PoseSpec& pose : poses) {
    const weft::Points3 truth_m = placed(templ, pose);
    PluginUnderTest solver("solvers/my_plugin", "{rounds: 20000}");
    const PluginAnswer answer =
        solver.process(0, {input("template", templ), input("camera", make_camera()),
                           input("sightlines", sightlines_to(templ, truth_m))});
    ASSERT_EQ(answer.status, WEFT_OK) << answer.message;
    const auto shape = *answer.get<weft::Shape>();
    EXPECT_EQ(shape.shape_state(), weft::ShapeState::estimated);
    EXPECT_LT((shape.vertices_m.matrix<3>() - truth_m).rowwise().norm().maxCoeff(), 1e-5);
  }
}

TEST(MyPluginSolver, SaysThatVerticesOnALineTellNoPose) {
  const weft::Template templ = make_template();
  weft::Sightlines lines = sightlines_to(templ, placed(templ, {}));
  for (std::int64_t i = 0; i < lines.count(); ++i) lines.weight(i) = i < 10 ? 1.0 : 0.0;  // a row
  PluginUnderTest solver("solvers/my_plugin");
  const PluginAnswer answer = solver.process(
      0, {input("template", templ), input("camera", make_camera()), input("sightlines", lines)});
  EXPECT_EQ(answer.status, WEFT_NO_RESULT);
}

}  // namespace
