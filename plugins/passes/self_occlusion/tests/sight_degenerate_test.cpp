// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <vector>
#include <weft/core/index.hpp>
#include <weft/geometry/mesh_adjacency.hpp>
#include <weft/geometry/rectangular_grid.hpp>
#include <weft/testing/synthetic.hpp>

#include "sight.hpp"

namespace weft::self_occlusion {
namespace {

/// A line across the view, from which squares extend 5 cm up and down.
struct Segment {
  double x0_m, z0_m, x1_m, z1_m;
};

/// The reasons of the vertices of squares, 4 each: left top, right top, left bottom, right bottom.
std::vector<SightReason> reasons_of(const std::vector<Segment>& segments,
                                    const std::vector<int>& vertex) {
  const Faces square = *rectangular_grid_faces(2, 2);
  const auto count = static_cast<Eigen::Index>(segments.size());
  Points3 vertices_m = Points3::Zero(4 * count, 3);
  Faces faces(2 * count, 3);
  for (Eigen::Index s = 0; s < count; ++s) {
    const Segment& each = segments[to_index(s)];
    for (Eigen::Index k = 0; k < 4; ++k) {
      const double y_m = k < 2 ? -0.05 : 0.05;
      const auto at = vertex[to_index(4 * s + k)];
      vertices_m.row(at) << (k % 2 == 0 ? each.x0_m : each.x1_m), y_m,
          (k % 2 == 0 ? each.z0_m : each.z1_m);
    }
    for (Eigen::Index f = 0; f < 2; ++f) {
      for (Eigen::Index c = 0; c < 3; ++c) {
        faces(2 * s + f, c) = vertex[to_index(4 * s + square(f, c))];
      }
    }
  }
  auto scene = scene::RayCaster::create();
  EXPECT_TRUE(scene) << scene.error().message;
  return look(vertices_m, faces, vertex_faces(faces, vertices_m.rows()), testing::make_camera(),
              *scene)
      .reason;
}

TEST(SightOfDegenerateMeshes, DistinguishesThreeSquaresAtOneEdge) {
  // The third goes back from the edge that it shares with the others, behind the second.
  const auto reason =
      reasons_of({{-0.05, 0.5, 0.0, 0.5}, {0.0, 0.5, 0.05, 0.5}, {0.0, 0.5, 0.04, 0.6}},
                 {0, 1, 2, 3, 1, 4, 3, 5, 1, 6, 3, 7});
  for (const std::size_t v : {0U, 1U, 2U, 3U, 4U, 5U}) EXPECT_EQ(reason[v], SightReason::seen) << v;
  for (const std::size_t v : {6U, 7U}) EXPECT_EQ(reason[v], SightReason::hidden) << v;
}

TEST(SightOfDegenerateMeshes, TellsOfSquaresThatPassThroughEachOtherWhatIsBehind) {
  const auto reason =
      reasons_of({{-0.05, 0.5, 0.05, 0.5}, {-0.05, 0.45, 0.05, 0.55}}, {0, 1, 2, 3, 4, 5, 6, 7});
  for (const std::size_t v : {0U, 2U, 5U, 7U}) EXPECT_EQ(reason[v], SightReason::hidden) << v;
  for (const std::size_t v : {1U, 3U, 4U, 6U}) EXPECT_EQ(reason[v], SightReason::seen) << v;
}

}  // namespace
}  // namespace weft::self_occlusion
