// SPDX-License-Identifier: Apache-2.0
#include "fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>
#include <weft/core/statistics.hpp>
#include <weft/geometry/mesh_validation.hpp>

namespace weft::particle_sft {
namespace {

constexpr double kUsualNoisePx = 0.5;
constexpr double kUsualStrain = 0.02;

/// True if most faces with three sightlines at vertices turn the other way than in the image.
bool turns_the_other_way(const MeshModel& mesh, const Sightlines& sightlines, const Pinhole& camera,
                         const Points3& vertices_m) {
  Points2 measured_px =
      Points2::Constant(vertices_m.rows(), 2, std::numeric_limits<double>::quiet_NaN());
  for (std::int64_t i = 0; i < sightlines.count(); ++i) {
    if (sightlines.vertex(i) < 0 || sightlines.weight(i) == 0.0) continue;
    measured_px.row(sightlines.vertex(i)) << sightlines.pixel_px(i, 0), sightlines.pixel_px(i, 1);
  }
  const Points2 projected_px = project_points(camera, vertices_m);
  int agree = 0, differ = 0;
  for (Eigen::Index f = 0; f < mesh.faces().rows(); ++f) {
    const double product = signed_area_px2(measured_px, mesh.faces(), f) *
                           signed_area_px2(projected_px, mesh.faces(), f);
    agree += product > 0.0 ? 1 : 0;
    differ += product < 0.0 ? 1 : 0;
  }
  return differ > agree;
}

}  // namespace

std::vector<RayConstraint> ray_constraints(const Sightlines& lines, const Faces& faces) {
  std::vector<RayConstraint> rays;
  for (std::int64_t i = 0; i < lines.count(); ++i) {
    if (lines.weight(i) == 0.0) continue;
    const bool at_vertex = lines.vertex(i) >= 0;
    RayConstraint seen;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto column = static_cast<std::int64_t>(k);
      seen.vertices[k] = at_vertex ? lines.vertex(i) : faces(lines.face(i), column);
      seen.weights[k] = at_vertex ? (k == 0 ? 1.0 : 0.0) : lines.barycentrics(i, column);
      seen.ray[k] = lines.ray(i, column);
    }
    seen.trust = std::min(lines.weight(i), 1.0);
    rays.push_back(seen);
  }
  return rays;
}

Eigen::Vector3d seen_point_m(const RayConstraint& seen, const Points3& vertices_m) {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  for (std::size_t c = 0; c < 3; ++c) {
    point += seen.weights[c] * vertices_m.row(seen.vertices[c]).transpose();
  }
  return point;
}

Fit assess(const MeshModel& mesh, const ParticleSystem& system, const Sightlines& sightlines,
           const Pinhole& camera, const Points3& vertices_m) {
  Fit fit;
  std::vector<double> residuals;
  double data = 0.0;
  for (const RayConstraint& seen : system.rays) {
    const Eigen::Vector3d ray(seen.ray[0], seen.ray[1], seen.ray[2]);
    residuals.push_back(distance_to_ray_px(camera, seen_point_m(seen, vertices_m), ray));
    data += seen.trust * std::pow(residuals.back() / kUsualNoisePx, 2);
  }
  data /= static_cast<double>(residuals.size());
  fit.residual_px = median_in_place(residuals);
  const std::vector<double> edge_strains = strains(mesh.stretch(), vertices_m);
  double lengths = 0.0;
  for (const double strain : edge_strains) lengths += std::pow(strain / kUsualStrain, 2);
  fit.strain = mean(edge_strains);
  fit.energy = data + lengths / static_cast<double>(edge_strains.size());
  fit.crease = percentile(edge_strains, 95.0);
  fit.mirrored = turns_the_other_way(mesh, sightlines, camera, vertices_m);
  return fit;
}

solvers::ImageMotion image_motion(const ParticleSystem& system, const Pinhole& camera,
                                  const Points3& vertices_m) {
  const auto count = static_cast<Eigen::Index>(system.rays.size());
  Points2 measured_px(count, 2), projected_px(count, 2);
  for (Eigen::Index i = 0; i < count; ++i) {
    const RayConstraint& seen = system.rays[to_index(i)];
    const Eigen::Vector3d ray(seen.ray[0], seen.ray[1], seen.ray[2]);
    measured_px.row(i) = project(camera, ray).transpose();
    projected_px.row(i) = project(camera, seen_point_m(seen, vertices_m)).transpose();
  }
  return solvers::image_motion(measured_px, projected_px);
}

}  // namespace weft::particle_sft
