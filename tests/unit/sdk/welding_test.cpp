// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/owned.hpp>
#include <weft/geometry/known_surface.hpp>

#include "solver_fixture.hpp"
#include "support/charted_objects.hpp"

namespace weft::welding_test {
namespace {

using ::testing::HasSubstr;

using charted::charted_cube;
using charted::charted_cylinder;
using WeldingTest = SolverFixture;

/// How many faces have each directed edge.
std::map<std::pair<std::int32_t, std::int32_t>, int> directed_edges(const Template& templ) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> count;
  for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) ++count[{templ.faces(f, k), templ.faces(f, (k + 1) % 3)}];
  }
  return count;
}

int open_edges(const Template& templ) {
  const auto edges = directed_edges(templ);
  int open = 0;
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    open += edges.contains({edge.second, edge.first}) ? 0 : 1;
  }
  return open;
}

TEST_F(WeldingTest, ACubeOfSixChartsIsOneClosedSurface) {
  const Template cube = charted_cube(4);
  ASSERT_EQ(cube.vertices_m.rows(), 6 * 16);
  ASSERT_EQ(open_edges(cube), 6 * 12);
  const auto solve = [&](const SolverInput& in) -> Result<Shape> {
    EXPECT_FALSE(in.templ.welded_vertex.present());
    EXPECT_EQ(in.templ.vertices_m.rows(), 56);  // 4^3 points without the 2^3 inner ones
    EXPECT_EQ(in.templ.flat_px.rows(), 56);
    EXPECT_EQ(in.templ.faces.rows(), cube.faces.rows());
    EXPECT_EQ(in.templ.texture.data(), cube.texture.data());
    EXPECT_EQ(open_edges(in.templ), 0);
    for (std::int64_t f = 0; f < cube.faces.rows(); ++f) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(in.templ.vertices_m.matrix<3>().row(in.templ.faces(f, k)),
                  cube.vertices_m.matrix<3>().row(cube.faces(f, k)));
      }
    }
    return at_rest(in.templ);
  };
  EXPECT_EQ(run(cube, solve), WEFT_OK) << error_.message;
}

TEST_F(WeldingTest, ACylinderOfTwoChartsIsOpenOnlyAtItsEnds) {
  const Template cylinder = charted_cylinder(8, 5);
  const auto solve = [&](const SolverInput& in) -> Result<Shape> {
    EXPECT_EQ(in.templ.vertices_m.rows(), 16 * 5);
    EXPECT_EQ(open_edges(in.templ), 2 * 16);
    return at_rest(in.templ);
  };
  EXPECT_EQ(cylinder.vertices_m.rows(), 2 * 9 * 5);
  EXPECT_EQ(run(cylinder, solve), WEFT_OK) << error_.message;
}

TEST_F(WeldingTest, TheShapeHasAllVerticesOfTheTemplateAndEqualTwins) {
  const Template cube = charted_cube(3);
  const auto solve = [](const SolverInput& in) -> Result<Shape> {
    Shape shape = at_rest(in.templ);
    const std::int64_t count = in.templ.vertices_m.rows();
    shape.covariance_m2 = Array<double>({count, 3, 3}, 0.0);
    shape.nodes_m = Array<double>({2, 3}, 7.0);
    shape.diag.set("per_place", Array<double>({count}, 1.0));
    for (std::int64_t w = 0; w < count; ++w) {
      shape.vertices_m(w, 0) = static_cast<double>(w);
      shape.source(w) = static_cast<std::uint8_t>(w % 2);
      shape.covariance_m2(w, 8) = static_cast<double>(w);
    }
    return shape;
  };
  ASSERT_EQ(run(cube, solve), WEFT_OK) << error_.message;
  const auto& vertices = host_.outputs.at("vertices_m");
  const auto& covariance = host_.outputs.at("covariance_m2");
  const auto& source = host_.outputs.at("source");
  EXPECT_EQ(vertices.shape, (std::vector<std::int64_t>{54, 3}));
  EXPECT_EQ(covariance.shape, (std::vector<std::int64_t>{54, 3, 3}));
  EXPECT_EQ(source.shape, (std::vector<std::int64_t>{54}));
  EXPECT_EQ(host_.outputs.at("nodes_m").shape, (std::vector<std::int64_t>{2, 3}));
  EXPECT_EQ(host_.outputs.at("diag.per_place").shape, (std::vector<std::int64_t>{26}));
  std::set<double> places;
  for (std::size_t v = 0; v < 54; ++v) {
    const auto first = to_index(cube.welded_vertex(static_cast<std::int64_t>(v)));
    const double place = vertices.numbers()[3 * v];
    EXPECT_EQ(place, vertices.numbers()[3 * first]);
    EXPECT_EQ(covariance.numbers()[9 * v + 8], place);
    EXPECT_EQ(source.bytes()[v], static_cast<int>(place) % 2);
    places.insert(place);
  }
  EXPECT_EQ(places.size(), 26U);
}

TEST_F(WeldingTest, APlaceIsVisibleIfOneOfItsVerticesIs) {
  const Template cube = charted_cube(2);  // corners only, three vertices at each
  input_.visibility.emplace();
  Visibility& seen = *input_.visibility;
  seen.visible = Array<std::uint8_t>({24}, 0);
  seen.score = Array<double>({24}, 0.1);
  seen.reason = Array<std::uint8_t>({24}, static_cast<std::uint8_t>(SightReason::faces_away));
  std::vector<std::int64_t> twins;
  for (std::int64_t v = 0; v < 24; ++v) {
    if (cube.welded_vertex(v) == 1) twins.push_back(v);
  }
  ASSERT_EQ(twins.size(), 3U);
  seen.visible(twins[2]) = 1;
  seen.score(twins[2]) = 0.8;
  seen.reason(twins[2]) = static_cast<std::uint8_t>(SightReason::seen);
  input_.previous_shape = at_rest(cube);
  input_.previous_shape->source(0) = 0;
  const auto solve = [](const SolverInput& in) -> Result<Shape> {
    EXPECT_EQ(in.visibility->visible.rows(), 8);
    for (std::int64_t w = 0; w < 8; ++w) {
      EXPECT_EQ(in.visibility->visible(w), w == 1 ? 1 : 0);
      EXPECT_EQ(in.visibility->score(w), w == 1 ? 0.8 : 0.1);
      EXPECT_EQ(in.visibility->why(w), w == 1 ? SightReason::seen : SightReason::faces_away);
    }
    EXPECT_EQ(in.previous_shape->vertices_m.rows(), 8);
    EXPECT_EQ(in.previous_shape->source.rows(), 8);
    EXPECT_EQ(in.previous_shape->source(0), 0);
    EXPECT_EQ(in.previous_shape->vertices_m(5, 0), in.templ.vertices_m(5, 0));
    return at_rest(in.templ);
  };
  EXPECT_EQ(run(cube, solve), WEFT_OK) << error_.message;
}

TEST_F(WeldingTest, TwoSightlinesOfOnePlaceStayTwo) {
  const Template cube = charted_cube(2);
  std::int32_t twin = 2;
  while (cube.welded_vertex(twin) != 1) ++twin;
  Sightlines& lines = input_.sightlines.emplace();
  lines.vertex = Array<std::int32_t>({3}, -1);
  lines.vertex(0) = 1;
  lines.vertex(1) = twin;
  lines.face = Array<std::int32_t>({3}, 11);
  lines.barycentrics = Array<double>({3, 3}, 1.0 / 3.0);
  lines.pixel_px = Array<double>({3, 2}, 100.0);
  lines.ray = Array<double>({3, 3}, 0.5);
  lines.weight = Array<double>({3}, 1.0);
  const auto solve = [&](const SolverInput& in) -> Result<Shape> {
    EXPECT_EQ(in.sightlines->count(), 3);
    EXPECT_EQ(in.sightlines->vertex(0), 1);
    EXPECT_EQ(in.sightlines->vertex(1), 1);
    EXPECT_EQ(in.sightlines->vertex(2), -1);
    EXPECT_EQ(in.sightlines->face.data(), input_.sightlines->face.data());
    EXPECT_EQ(in.sightlines->barycentrics.data(), input_.sightlines->barycentrics.data());
    return at_rest(in.templ);
  };
  EXPECT_EQ(run(cube, solve), WEFT_OK) << error_.message;
}

TEST_F(WeldingTest, KnownPointsArriveAtTheirPlaceOnBothSidesOfASeam) {
  const Template cube = charted_cube(2);  // each face is at a seam
  const std::int64_t last = cube.vertices_m.rows() - 1;
  KnownPoints& known = input_.known_points.emplace();
  known.vertex = Array<std::int32_t>({4}, -1);
  known.vertex(3) = static_cast<std::int32_t>(last);
  known.points_m = Array<double>({4, 3}, 1.0);
  known.radius_m = Array<double>({4}, 0.0);
  known.template_xy_m = Array<double>({4, 2}, 0.0);
  const std::array<std::int64_t, 3> sides{0, 5, 11};  // faces of different charts
  const Eigen::Vector3d weights(0.5, 0.3, 0.2);
  Points3 expected_m(4, 3);
  for (std::int64_t p = 0; p < 3; ++p) {
    Eigen::Vector2d place_px = Eigen::Vector2d::Zero();
    expected_m.row(p).setZero();
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = cube.faces(sides[to_index(p)], k);
      place_px += weights[k] * cube.flat_px.matrix<2>().row(v).transpose();
      expected_m.row(p) += weights[k] * cube.vertices_m.matrix<3>().row(v);
    }
    for (int axis = 0; axis < 2; ++axis) {
      known.template_xy_m(p, axis) = place_px[axis] * cube.m_per_px(axis);
    }
  }
  expected_m.row(3) = cube.vertices_m.matrix<3>().row(last);
  const auto solve = [&](const SolverInput& in) -> Result<Shape> {
    const auto points = known_surface_points(*in.known_points, in.templ, 0.001);
    if (!points) return points.error();
    EXPECT_EQ(points->size(), 4U);
    for (std::size_t p = 0; p < points->size(); ++p) {
      const Eigen::Vector3d place_m = (*points)[p].on(in.templ.vertices_m.matrix<3>());
      EXPECT_LT((place_m - expected_m.row(static_cast<Eigen::Index>(p)).transpose()).norm(), 1e-12);
    }
    return at_rest(in.templ);
  };
  EXPECT_EQ(run(cube, solve), WEFT_OK) << error_.message;
  known.template_xy_m(1, 0) = 1e3;
  EXPECT_EQ(run(cube, solve), WEFT_ERROR);
  EXPECT_THAT(error_.message, HasSubstr("known point 1 is at (1000000"));
}

TEST_F(WeldingTest, ATemplateWithoutSeamsIsNotCopied) {
  Template cube = charted_cube(3);
  cube.welded_vertex = {};
  cube.revision = 5;
  input_.previous_shape = at_rest(cube);
  const auto solve = [&](const SolverInput& in) -> Result<Shape> {
    EXPECT_EQ(in.templ.vertices_m.data(), cube.vertices_m.data());
    EXPECT_EQ(in.templ.faces.data(), cube.faces.data());
    EXPECT_EQ(in.templ.flat_px.data(), cube.flat_px.data());
    EXPECT_EQ(in.templ.revision, 5U);
    EXPECT_EQ(in.previous_shape->vertices_m.data(), input_.previous_shape->vertices_m.data());
    return at_rest(in.templ);
  };
  EXPECT_EQ(run(cube, solve), WEFT_OK) << error_.message;
  EXPECT_EQ(host_.outputs.at("vertices_m").shape, (std::vector<std::int64_t>{54, 3}));
}

TEST_F(WeldingTest, ASolverOfThePlaneReceivesTheSeams) {
  const Template cube = charted_cube(3);
  solver_.joins = false;
  const auto solve = [&](const SolverInput& in) -> Result<Shape> {
    EXPECT_EQ(in.templ.vertices_m.data(), cube.vertices_m.data());
    EXPECT_TRUE(in.templ.welded_vertex.present());
    return at_rest(in.templ);
  };
  EXPECT_EQ(run(cube, solve), WEFT_OK) << error_.message;
}

TEST_F(WeldingTest, TheRevisionChangesWithThatOfTheTemplate) {
  Template cube = charted_cube(3), cylinder = charted_cylinder(4, 3);
  std::vector<std::uint64_t> revisions;
  std::vector<std::int64_t> counts;
  const SolverComponent nested("solvers/any");
  const auto solve = [&](const SolverInput& in) -> Result<Shape> {
    revisions.push_back(in.templ.revision);
    counts.push_back(in.templ.vertices_m.rows());
    EXPECT_FALSE(nested.solve(in));  // this host refuses it
    return at_rest(in.templ);
  };
  const auto with_revision = [](Template& templ, std::uint64_t revision) {
    templ.revision = revision;
    return templ;
  };
  for (const std::uint64_t revision : {7U, 7U, 8U, 0U}) {
    EXPECT_EQ(run(with_revision(cube, revision), solve), WEFT_OK) << error_.message;
    EXPECT_EQ(run(with_revision(cylinder, revision + (revision == 0 ? 0 : 10)), solve), WEFT_OK);
  }
  EXPECT_EQ(counts, (std::vector<std::int64_t>{26, 24, 26, 24, 26, 24, 26, 24}));
  EXPECT_EQ(revisions[0], revisions[2]);
  EXPECT_EQ(revisions[1], revisions[3]);
  const std::set<std::uint64_t> different(revisions.begin(), revisions.end());
  EXPECT_EQ(different.size(), 5U);  // 7, 17, 8, 18 and 0
  EXPECT_EQ(different.count(7) + different.count(8) + different.count(17), 0U);
  EXPECT_EQ(revisions[6], 0U);
  EXPECT_EQ(host_.nested_revisions, revisions);
  EXPECT_THAT(host_.nested_seams, ::testing::Each(false));
}

TEST_F(WeldingTest, AKeptWeldingIsThatOfItsTemplate) {
  Template first = charted_cube(3), second = charted_cube(3);
  first.revision = second.revision = 0;
  second.vertices_m(0, 0) += 0.25;
  double x_m = 0.0;
  const auto solve = [&](const SolverInput& in) -> Result<Shape> {
    x_m = in.templ.vertices_m(0, 0);
    return at_rest(in.templ);
  };
  ASSERT_EQ(run(first, solve), WEFT_OK);
  EXPECT_EQ(x_m, first.vertices_m(0, 0));
  ASSERT_EQ(run(second, solve), WEFT_OK);
  EXPECT_EQ(x_m, second.vertices_m(0, 0));
}

TEST_F(WeldingTest, AVertexWithoutAFirstVertexIsAnError) {
  Template cube = charted_cube(3);
  const auto solve = [](const SolverInput& in) -> Result<Shape> { return at_rest(in.templ); };
  for (const std::int32_t wrong : {-1, 10, 999}) {
    Template broken = cube;
    broken.welded_vertex = owned(cube.welded_vertex);
    broken.welded_vertex(9) = wrong;
    EXPECT_EQ(run(broken, solve), WEFT_ERROR);
    EXPECT_THAT(error_.message, HasSubstr("welded_vertex of vertex 9 is " + std::to_string(wrong)));
  }
}

TEST_F(WeldingTest, ASolidTemplateKeepsItsTetrahedraAndTheRowsOfItsPlaces) {
  Template cube = charted_cube(2);
  cube.nodes_m = Array<double>({4, 3}, 0.0);
  cube.tetrahedra = Array<std::int32_t>({1, 4}, 0);
  cube.vertex_tetrahedron = Array<std::int32_t>({24}, 0);
  cube.vertex_barycentric = Array<double>({24, 4}, 0.25);
  for (std::int64_t v = 0; v < 24; ++v) {
    cube.vertex_barycentric(v, 0) = static_cast<double>(cube.welded_vertex(v));
  }
  const auto solve = [&](const SolverInput& in) -> Result<Shape> {
    EXPECT_TRUE(in.templ.is_solid());
    EXPECT_EQ(in.templ.nodes_m.data(), cube.nodes_m.data());
    EXPECT_EQ(in.templ.vertex_tetrahedron.rows(), 8);
    EXPECT_EQ(in.templ.vertex_barycentric.rows(), 8);
    std::set<double> firsts;
    for (std::int64_t w = 0; w < 8; ++w) firsts.insert(in.templ.vertex_barycentric(w, 0));
    EXPECT_EQ(firsts.size(), 8U);
    return at_rest(in.templ);
  };
  EXPECT_EQ(run(cube, solve), WEFT_OK) << error_.message;
}

}  // namespace
}  // namespace weft::welding_test
