// SPDX-License-Identifier: Apache-2.0
#include "known_spheres.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

namespace weft::particle_sft {
namespace {

constexpr double kAllowedStretch = 1.02;

}  // namespace

Result<std::vector<SphereConstraint>> spheres_of(const KnownPoints& known, double default_radius_m,
                                                 Eigen::Index vertex_count) {
  std::vector<SphereConstraint> spheres;
  for (std::int64_t p = 0; p < known.count(); ++p) {
    const double* x = known.points_m.row(p);
    const double radius_m = known.radius_m(p);
    const std::string name = "known point " + std::to_string(p);
    if (known.vertex(p) < 0 || known.vertex(p) >= vertex_count) {
      return Error{Errc::invalid_data,
                   name + " names vertex " + std::to_string(known.vertex(p)) +
                       " of a template with " + std::to_string(vertex_count),
                   {}};
    }
    if (!std::isfinite(x[0]) || !std::isfinite(x[1]) || !std::isfinite(x[2]) ||
        !std::isfinite(radius_m)) {
      return Error{Errc::invalid_data, name + " is not finite: leave it out", {}};
    }
    spheres.push_back(
        {known.vertex(p), {x[0], x[1], x[2]}, radius_m < 0.0 ? default_radius_m : radius_m});
  }
  return spheres;
}

int make_consistent(const MeshModel& mesh, std::vector<SphereConstraint>& spheres) {
  std::vector<double> grown_m;
  for (const SphereConstraint& sphere : spheres) grown_m.push_back(sphere.radius_m);
  int pairs = 0;
  for (std::size_t a = 0; a < spheres.size(); ++a) {
    for (std::size_t b = a + 1; b < spheres.size(); ++b) {
      double apart2 = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        apart2 += std::pow(spheres[a].centre_m[k] - spheres[b].centre_m[k], 2);
      }
      const double reach_m =
          kAllowedStretch * mesh.surface_length_m(spheres[a].vertex, spheres[b].vertex);
      const double excess_m =
          std::sqrt(apart2) - reach_m - spheres[a].radius_m - spheres[b].radius_m;
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
