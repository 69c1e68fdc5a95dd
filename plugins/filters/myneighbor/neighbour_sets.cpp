// SPDX-License-Identifier: Apache-2.0
#include "neighbour_sets.hpp"

#include <algorithm>
#include <boost/polygon/voronoi.hpp>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::myneighbor {
namespace {

using Diagram = boost::polygon::voronoi_diagram<double>;
using Links = std::vector<std::pair<std::int32_t, std::int32_t>>;

/// A point in steps of a grid that covers all points. Boost.Polygon is exact on whole numbers of 32
/// bits, and these have 31 with their sign, so that differences have no more than 32.
struct Site {
  std::int32_t x = 0, y = 0;

  bool operator==(const Site&) const = default;
  bool operator<(const Site& other) const { return std::tie(x, y) < std::tie(other.x, other.y); }
};
constexpr int kStepBits = 30;

/// The nearest points of a grid, where the larger half-extent has 2^29 to 2^30 steps, a power of
/// two each. Points on the grid, such as whole pixels, stay unchanged. None where all points are in
/// one place.
std::optional<std::vector<Site>> on_grid(const Points2View& points) {
  if (points.rows() == 0) return std::nullopt;
  const Eigen::RowVector2d low = 0.5 * points.colwise().minCoeff();
  const Eigen::RowVector2d high = 0.5 * points.colwise().maxCoeff();
  const Eigen::RowVector2d middle = low + high;
  const double half_extent = (high - low).maxCoeff();
  if (!(half_extent > 0.0)) return std::nullopt;
  int exponent = 0;
  std::frexp(half_extent, &exponent);
  const auto step = [&](double offset) {
    return static_cast<std::int32_t>(std::lround(std::ldexp(offset, kStepBits - exponent)));
  };
  std::vector<Site> sites(to_index(points.rows()));
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    sites[i] = {step(points(row, 0) - middle.x()), step(points(row, 1) - middle.y())};
  }
  return sites;
}

/// The different sites, from left to right; fills vertex_of.
std::vector<Site> unique_sites(const std::vector<Site>& sites,
                               std::vector<std::int32_t>& vertex_of) {
  std::vector<std::int32_t> order(sites.size());
  std::iota(order.begin(), order.end(), 0);
  const auto site = [&](std::int32_t i) { return sites[to_index(i)]; };
  std::sort(order.begin(), order.end(),
            [&](std::int32_t a, std::int32_t b) { return site(a) < site(b); });
  std::vector<Site> different;
  different.reserve(sites.size());
  vertex_of.resize(sites.size());
  for (const std::int32_t i : order) {
    if (different.empty() || different.back() != site(i)) different.push_back(site(i));
    vertex_of[to_index(i)] = static_cast<std::int32_t>(different.size()) - 1;
  }
  return different;
}

/// True if all sites, sorted, are within two steps of a line. Rounding to the grid moves the points
/// of any line by no more than that.
bool on_a_line(const std::vector<Site>& sites) {
  const auto arm = [](const Site& from, const Site& to) {
    return Eigen::Vector2d(static_cast<double>(to.x) - from.x, static_cast<double>(to.y) - from.y);
  };
  const auto [lowest, highest] = std::minmax_element(
      sites.begin(), sites.end(), [](const Site& a, const Site& b) { return a.y < b.y; });
  const Eigen::Vector2d across = arm(sites.front(), sites.back()), up = arm(*lowest, *highest);
  const bool steep = up.y() > across.x();
  const Site& end = steep ? *lowest : sites.front();
  const Eigen::Vector2d line = (steep ? up : across).normalized();
  return std::all_of(sites.begin(), sites.end(), [&](const Site& site) {
    const Eigen::Vector2d offset = arm(end, site);
    return std::abs(line.x() * offset.y() - line.y() * offset.x()) <= 2.0;
  });
}

/// Pairs of vertices whose cells of the Voronoi diagram share a side, in both directions, and each
/// vertex with itself. The diagonals of a square are no pairs: there the cells share a corner.
Links links_of(const std::vector<Site>& sites) {
  boost::polygon::default_voronoi_builder builder;
  for (const Site& site : sites) builder.insert_point(site.x, site.y);
  Diagram diagram;
  builder.construct(&diagram);
  Links links;
  links.reserve(diagram.num_edges() + sites.size());
  for (const Diagram::edge_type& edge : diagram.edges()) {
    worked(2);
    links.emplace_back(static_cast<std::int32_t>(edge.cell()->source_index()),
                       static_cast<std::int32_t>(edge.twin()->cell()->source_index()));
  }
  for (std::size_t v = 0; v < sites.size(); ++v) {
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
  const auto moved = on_grid(points);
  if (!moved) return false;
  const std::vector<Site> sites = unique_sites(*moved, sets.vertex_of);
  if (on_a_line(sites)) return false;
  const Links links = links_of(sites);

  std::vector<std::int32_t> first_link(sites.size() + 1, 0), population(sites.size(), 0);
  for (const auto& link : links) ++first_link[to_index(link.first) + 1];
  accumulate(first_link);
  std::vector<std::int32_t> targets(links.size()), cursor(first_link);
  for (const auto& [from, to] : links) {
    targets[to_index(cursor[to_index(from)]++)] = to;
  }
  for (const std::int32_t vertex : sets.vertex_of) ++population[to_index(vertex)];

  sets.offsets.assign(sites.size() + 1, 0);
  for (const auto& [from, to] : links) {
    sets.offsets[to_index(from) + 1] += population[to_index(to)];
  }
  accumulate(sets.offsets);
  sets.items.resize(to_index(sets.offsets.back()));
  cursor.assign(sets.offsets.begin(), sets.offsets.end());
  // Points in ascending order go to the sets of all vertices around: each set comes out ascending.
  for (std::size_t i = 0; i < sets.vertex_of.size(); ++i) {
    const auto vertex = to_index(sets.vertex_of[i]);
    worked(10);
    for (std::int32_t link = first_link[vertex]; link < first_link[vertex + 1]; ++link) {
      const auto target = to_index(targets[to_index(link)]);
      sets.items[to_index(cursor[target]++)] = static_cast<std::int32_t>(i);
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
