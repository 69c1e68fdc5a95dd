// SPDX-License-Identifier: Apache-2.0
#include "known_spheres.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/geometry/surface_distance.hpp>

namespace weft::solvers {
namespace {

constexpr double kAllowedStretch = 1.02;

}  // namespace

double surface_length_m(const RestMesh& rest, const KnownSurfacePoint& from,
                        const KnownSurfacePoint& to) {
  const Points3& rest_m = rest.vertices_m;
  const Eigen::Vector3d origin = from.on(rest_m), target = to.on(rest_m);
  if (rest.is_flat || (from.face >= 0 && from.face == to.face)) return (origin - target).norm();
  std::array<PathStart, 3> starts;
  for (std::size_t k = 0; k < 3; ++k) {
    starts[k] = {from.vertices[k], (rest_m.row(from.vertices[k]).transpose() - origin).norm()};
  }
  const std::vector<double> paths_m = path_lengths_m(rest_m, rest.neighbours, starts);
  double length_m = std::numeric_limits<double>::infinity();
  for (const std::int32_t v : to.vertices) {
    const double rest_of_way_m = (rest_m.row(v).transpose() - target).norm();
    length_m = std::min(length_m, paths_m[to_index(v)] + rest_of_way_m);
  }
  return length_m;
}

int make_consistent(const RestMesh& rest, std::vector<KnownSurfacePoint>& spheres) {
  std::vector<double> grown_m;
  for (const KnownSurfacePoint& sphere : spheres) grown_m.push_back(sphere.radius_m);
  int pairs = 0;
  for (std::size_t a = 0; a < spheres.size(); ++a) {
    for (std::size_t b = a + 1; b < spheres.size(); ++b) {
      const double distance_m = (spheres[a].centre_m - spheres[b].centre_m).norm();
      const double reach_m = kAllowedStretch * surface_length_m(rest, spheres[a], spheres[b]);
      const double excess_m = distance_m - reach_m - spheres[a].radius_m - spheres[b].radius_m;
      if (!(excess_m > 0.0)) continue;
      ++pairs;
      grown_m[a] = std::max(grown_m[a], spheres[a].radius_m + 0.5 * excess_m);
      grown_m[b] = std::max(grown_m[b], spheres[b].radius_m + 0.5 * excess_m);
    }
  }
  for (std::size_t a = 0; a < spheres.size(); ++a) spheres[a].radius_m = grown_m[a];
  return pairs;
}

}  // namespace weft::solvers
