// SPDX-License-Identifier: Apache-2.0
#include "known_spheres.hpp"

#include <algorithm>
#include <cstddef>

namespace weft::particle_sft {
namespace {

constexpr double kAllowedStretch = 1.02;

}  // namespace

int make_consistent(const MeshModel& mesh, std::vector<KnownSurfacePoint>& spheres) {
  std::vector<double> grown_m;
  for (const KnownSurfacePoint& sphere : spheres) grown_m.push_back(sphere.radius_m);
  int pairs = 0;
  for (std::size_t a = 0; a < spheres.size(); ++a) {
    for (std::size_t b = a + 1; b < spheres.size(); ++b) {
      const double apart_m = (spheres[a].centre_m - spheres[b].centre_m).norm();
      const double reach_m = kAllowedStretch * mesh.surface_length_m(spheres[a], spheres[b]);
      const double excess_m = apart_m - reach_m - spheres[a].radius_m - spheres[b].radius_m;
      if (!(excess_m > 0.0)) continue;
      ++pairs;
      grown_m[a] = std::max(grown_m[a], spheres[a].radius_m + 0.5 * excess_m);
      grown_m[b] = std::max(grown_m[b], spheres[b].radius_m + 0.5 * excess_m);
    }
  }
  for (std::size_t a = 0; a < spheres.size(); ++a) spheres[a].radius_m = grown_m[a];
  return pairs;
}

}  // namespace weft::particle_sft
