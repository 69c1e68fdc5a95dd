// SPDX-License-Identifier: Apache-2.0
// Neighbours against those of CGAL's triangulation, which is exact on any numbers. This test alone
// includes CGAL; the plugin does not.
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <gtest/gtest.h>

#include <set>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

#include "neighbour_sets.hpp"

namespace {

using weft::Points2;
using weft::Rng;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangulation = CGAL::Delaunay_triangulation_2<Kernel>;
using Place = std::pair<double, double>;
using Links = std::set<std::pair<Place, Place>>;  ///< in both directions

/// The edges of the triangulation but the diagonals of corners that lie on one circle.
Links links_of_cgal(const Points2& points) {
  Triangulation triangulation;
  for (const auto& row : points.rowwise()) triangulation.insert({row.x(), row.y()});
  Links links;
  for (const auto& [face, k] : triangulation.finite_edges()) {
    const auto other = face->neighbor(k);
    const bool at_the_border = triangulation.is_infinite(face) || triangulation.is_infinite(other);
    if (!at_the_border &&
        triangulation.side_of_oriented_circle(
            face, triangulation.mirror_vertex(face, k)->point()) == CGAL::ON_ORIENTED_BOUNDARY) {
      continue;
    }
    const auto place = [](const auto& vertex) {
      return Place(vertex->point().x(), vertex->point().y());
    };
    const Place a = place(face->vertex(Triangulation::cw(k)));
    const Place b = place(face->vertex(Triangulation::ccw(k)));
    links.insert({{a, b}, {b, a}});
  }
  return links;
}

Links links_of_sets(const Points2& points) {
  weft::myneighbor::NeighbourSets sets;
  EXPECT_TRUE(build_neighbour_sets(points, sets));
  Links links;
  const auto place = [&](Eigen::Index i) { return Place(points(i, 0), points(i, 1)); };
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    for (const std::int32_t j : sets.with_self(weft::to_index(i))) {
      if (place(i) != place(j)) links.emplace(place(i), place(j));
    }
  }
  return links;
}

Points2 random_points(Eigen::Index count, double size, Rng& rng) {
  Points2 points(count, 2);
  for (Eigen::Index i = 0; i < points.size(); ++i) points.data()[i] = rng.uniform(0.0, size);
  return points;
}

TEST(NeighbourSets, AreThoseOfCgalForRandomPoints) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    for (const double size_px : {0.01, 640.0, 1e5}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::to_string(size_px) + " px");
      Rng rng(seed);
      const Points2 points = random_points(3000, size_px, rng);
      EXPECT_EQ(links_of_sets(points), links_of_cgal(points));
    }
  }
}

TEST(NeighbourSets, AreThoseOfCgalForWholePixelsOfWhichManyRepeatOrLieOnOneCircle) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const Points2 points = random_points(1000, 40.0, rng).array().round();
    EXPECT_EQ(links_of_sets(points), links_of_cgal(points));
  }
}

TEST(NeighbourSets, AreThoseOfCgalForAClusterInAWideField) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    Points2 points = random_points(600, 4000.0, rng);
    points.topRows(500) = 1e-3 * points.topRows(500) + Points2::Constant(500, 2, 300.0);
    EXPECT_EQ(links_of_sets(points), links_of_cgal(points));
  }
}

TEST(NeighbourSets, AreThoseOfCgalForPointsOnOneCircle) {
  constexpr int kRadius = 325;  // radius for 60 points with whole coordinates
  std::set<Place> places{{0.0, 0.0}, {400.0, 7.0}};
  for (int x = -kRadius; x <= kRadius; ++x) {
    for (int y = -kRadius; y <= kRadius; ++y) {
      if (x * x + y * y == kRadius * kRadius) places.emplace(x, y);
    }
  }
  for (const bool with_centre : {true, false}) {
    if (!with_centre) places.erase({0.0, 0.0});
    Points2 points(static_cast<Eigen::Index>(places.size()), 2);
    Eigen::Index row = 0;
    for (const auto& [x, y] : places) points.row(row++) << x, y;
    EXPECT_EQ(links_of_sets(points), links_of_cgal(points)) << "with centre: " << with_centre;
  }
}

}  // namespace
