// SPDX-License-Identifier: Apache-2.0
#include "confidence.hpp"

#include <cmath>
#include <weft/geometry/barycentric.hpp>

namespace weft::particle_sft {
namespace {

constexpr double kAgreeingPx = 3.0;

}  // namespace

Agreement agreement(const Correspondences& matches, const MeshModel& mesh, const Pinhole& camera,
                    const Points3& vertices_m) {
  Agreement result;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    if (matches.kept(i) == 0) continue;
    ++result.kept;
    if (matches.face(i) < 0) continue;
    const Eigen::Vector3d weights = matches.barycentrics.matrix<3>().row(i);
    const Eigen::Vector2d seen_px = matches.image_px.matrix<2>().row(i);
    const Eigen::Vector3d place_m = interpolate(vertices_m, mesh.faces(), matches.face(i), weights);
    const double apart_px = (project(camera, place_m) - seen_px).norm();
    result.agreeing += apart_px < kAgreeingPx ? 1 : 0;
  }
  return result;
}

Agreement agreement(const ParticleSystem& system, const Pinhole& camera,
                    const Points3& vertices_m) {
  Agreement result{static_cast<int>(system.rays.size()), 0};
  for (const RayConstraint& seen : system.rays) {
    const Eigen::Vector3d ray(seen.ray[0], seen.ray[1], seen.ray[2]);
    const double apart_px = distance_to_ray_px(camera, seen_point_m(seen, vertices_m), ray);
    result.agreeing += apart_px < kAgreeingPx ? 1 : 0;
  }
  return result;
}

double confidence(const Fit& fit, const Agreement& agreement) {
  const double agreeing = 1.0 + agreement.agreeing;
  const double logit = -26.08 - 1.862 * std::log(fit.residual_px + 0.1) -
                       2.973 * std::log(fit.strain + 1e-3) + 2.953 * std::log(agreeing) +
                       0.452 * std::log(agreeing / (1.0 + agreement.kept));
  return 1.0 / (1.0 + std::exp(-logit));
}

}  // namespace weft::particle_sft
