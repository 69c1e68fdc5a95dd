// SPDX-License-Identifier: Apache-2.0
#include "neighbour_sets.hpp"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <numeric>
#include <utility>
#include <weft/core/stop_check.hpp>

namespace weft::myneighbor {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel>;
using Triangulation =
    CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex>>;
using Sites = std::vector<std::pair<Kernel::Point_2, std::int32_t>>;
using Links = std::vector<std::pair<std::int32_t, std::int32_t>>;

/// The different points, numbered from left to right; fills vertex_of.
Sites unique_sites(const Points2View& points, std::vector<std::int32_t>& vertex_of) {
  const auto n = static_cast<std::size_t>(points.rows());
  std::vector<std::int32_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  const auto place = [&](std::int32_t i) { return std::pair(points(i, 0), points(i, 1)); };
  std::sort(order.begin(), order.end(),
            [&](std::int32_t a, std::int32_t b) { return place(a) < place(b); });
  Sites sites;
  sites.reserve(n);
  vertex_of.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const auto [x, y] = place(order[k]);
    if (k == 0 || place(order[k - 1]) != std::pair(x, y)) {
      sites.emplace_back(Kernel::Point_2(x, y), static_cast<std::int32_t>(sites.size()));
    }
    vertex_of[static_cast<std::size_t>(order[k])] = sites.back().second;
  }
  return sites;
}

/// Pairs of joined vertices in both directions, and each vertex with itself.
Links links_of(const Triangulation& triangulation, std::size_t vertices) {
  Links links;
  links.reserve(7 * vertices);
  for (const auto& edge : triangulation.finite_edges()) {
    worked(3);
    const std::int32_t a = edge.first->vertex(Triangulation::cw(edge.second))->info();
    const std::int32_t b = edge.first->vertex(Triangulation::ccw(edge.second))->info();
    links.emplace_back(a, b);
    links.emplace_back(b, a);
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    links.emplace_back(static_cast<std::int32_t>(v), static_cast<std::int32_t>(v));
  }
  return links;
}

/// Turns counts, stored one place to the right, into offsets.
void accumulate(std::vector<std::int32_t>& counts) {
  std::partial_sum(counts.begin(), counts.end(), counts.begin());
}

}  // namespace

bool build_neighbour_sets(const Points2View& points, NeighbourSets& sets) {
  const Sites sites = unique_sites(points, sets.vertex_of);
  const Triangulation triangulation(sites.begin(), sites.end());
  if (triangulation.dimension() < 2) return false;
  const Links links = links_of(triangulation, sites.size());

  std::vector<std::int32_t> first_link(sites.size() + 1, 0), population(sites.size(), 0);
  for (const auto& link : links) ++first_link[static_cast<std::size_t>(link.first) + 1];
  accumulate(first_link);
  std::vector<std::int32_t> targets(links.size()), cursor(first_link);
  for (const auto& [from, to] : links) {
    targets[static_cast<std::size_t>(cursor[static_cast<std::size_t>(from)]++)] = to;
  }
  for (const std::int32_t vertex : sets.vertex_of) ++population[static_cast<std::size_t>(vertex)];

  sets.offsets.assign(sites.size() + 1, 0);
  for (const auto& [from, to] : links) {
    sets.offsets[static_cast<std::size_t>(from) + 1] += population[static_cast<std::size_t>(to)];
  }
  accumulate(sets.offsets);
  sets.items.resize(static_cast<std::size_t>(sets.offsets.back()));
  cursor.assign(sets.offsets.begin(), sets.offsets.end());
  // Points in ascending order go to the sets of all vertices around: each set comes out ascending.
  for (std::size_t i = 0; i < sets.vertex_of.size(); ++i) {
    const auto vertex = static_cast<std::size_t>(sets.vertex_of[i]);
    worked(10);
    for (std::int32_t link = first_link[vertex]; link < first_link[vertex + 1]; ++link) {
      const auto target = static_cast<std::size_t>(targets[static_cast<std::size_t>(link)]);
      sets.items[static_cast<std::size_t>(cursor[target]++)] = static_cast<std::int32_t>(i);
    }
  }
  return true;
}

double mismatch_factor_percent(const NeighbourSets& p, const NeighbourSets& q, std::size_t i,
                               double empty_percent) {
  const auto in_p = p.with_self(i), in_q = q.with_self(i);
  worked(static_cast<std::int64_t>(in_p.size() + in_q.size()));
  std::size_t common = 0;
  for (auto a = in_p.begin(), b = in_q.begin(); a != in_p.end() && b != in_q.end();) {
    if (*a == *b) ++common;
    const bool next_a = *a <= *b, next_b = *b <= *a;
    a += next_a ? 1 : 0;
    b += next_b ? 1 : 0;
  }
  const std::size_t either = in_p.size() + in_q.size() - common;
  if (either <= 1) return empty_percent;
  return 100.0 * static_cast<double>(either - common) / static_cast<double>(either - 1);
}

}  // namespace weft::myneighbor
