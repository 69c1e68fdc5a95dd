// SPDX-License-Identifier: Apache-2.0
#include "common/shape_signs.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/camera_model.hpp>

namespace weft::solvers {
namespace {

double median_distance_px(const SolverInput& in, const Points3View& vertices_m) {
  if (!in.correspondences) return std::numeric_limits<double>::infinity();
  const Correspondences& matches = *in.correspondences;
  const auto faces = in.templ.faces.matrix<3>();
  const Pinhole camera{in.camera.fx, in.camera.fy, in.camera.cx, in.camera.cy};
  std::vector<double> distances_px;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    if (matches.kept(i) == 0 || matches.face(i) < 0) continue;
    const Eigen::Vector3d place_m =
        interpolate(vertices_m, faces, matches.face(i), matches.barycentrics.matrix<3>().row(i));
    const Eigen::Vector2d seen_px = matches.image_px.matrix<2>().row(i);
    distances_px.push_back((project(camera, place_m) - seen_px).norm());
  }
  if (distances_px.empty()) return std::numeric_limits<double>::infinity();
  return median_in_place(distances_px);
}

/// [3 F] rad: for each corner the angle between its face and the mean of the faces there.
std::vector<double> corner_angles_rad(const Points3View& vertices_m, const FacesView& faces) {
  Points3 of_faces(faces.rows(), 3);
  Points3 at_vertices = Points3::Zero(vertices_m.rows(), 3);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Eigen::Vector3d a = vertices_m.row(faces(f, 0));
    const Eigen::Vector3d b = vertices_m.row(faces(f, 1)).transpose() - a;
    const Eigen::Vector3d c = vertices_m.row(faces(f, 2)).transpose() - a;
    of_faces.row(f) = b.cross(c).normalized();
    for (int k = 0; k < 3; ++k) at_vertices.row(faces(f, k)) += of_faces.row(f);
  }
  std::vector<double> angles_rad;
  angles_rad.reserve(to_index(3 * faces.rows()));
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Eigen::Vector3d face = of_faces.row(f);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d there = at_vertices.row(faces(f, k));
      angles_rad.push_back(std::atan2(face.cross(there).norm(), face.dot(there)));
    }
  }
  return angles_rad;
}

double roughness_rad(const Template& templ, const Points3View& vertices_m) {
  const auto faces = templ.faces.matrix<3>();
  const auto at_rest = corner_angles_rad(templ.vertices_m.matrix<3>(), faces);
  std::vector<double> angles_rad = corner_angles_rad(vertices_m, faces);
  for (std::size_t k = 0; k < angles_rad.size(); ++k) {
    angles_rad[k] = std::abs(angles_rad[k] - at_rest[k]);
  }
  return mean(angles_rad);
}

double size_px(const Camera& camera, const Points3View& vertices_m) {
  const Points2 pixels =
      project_points(Pinhole{camera.fx, camera.fy, camera.cx, camera.cy}, vertices_m);
  return (pixels.colwise().maxCoeff() - pixels.colwise().minCoeff()).norm();
}

}  // namespace

ShapeSigns shape_signs(const SolverInput& in, std::span<const DistanceConstraint> edges,
                       const Points3View& vertices_m) {
  const StrainStatistics strain = strain_statistics(edges, vertices_m);
  return {strain.mean,
          strain.p95,
          median_distance_px(in, vertices_m),
          roughness_rad(in.templ, vertices_m),
          size_px(in.camera, vertices_m),
          shape_evidence(in.templ, in.camera, vertices_m, in.correspondences, in.sightlines)};
}

void ShapeSigns::tell(Diagnostics& diag) const {
  diag.set("strain", strain);
  diag.set("strain_p95", strain_p95);
  diag.set("kept_residual_px", residual_px);
  diag.set("roughness_rad", roughness_rad);
  diag.set("size_px", size_px);
}

double confidence(const ShapeSigns& signs, const ConfidenceWeights& weights,
                  const std::optional<Correspondences>& matches) {
  const ShapeEvidence& evidence = signs.evidence;
  const double agreeing = 1.0 + evidence.agreeing;
  const double logit = weights.bias + weights.strain * std::log(signs.strain + 1e-3) +
                       weights.strain_p95 * std::log(signs.strain_p95 + 1e-3) +
                       weights.residual * std::log(signs.residual_px + 0.1) +
                       weights.roughness * std::log(signs.roughness_rad + 0.01) +
                       weights.size * std::log(signs.size_px + 1.0) +
                       weights.agreeing * std::log(agreeing) +
                       weights.share * std::log(agreeing / (1.0 + evidence.kept)) +
                       weights.coverage * std::log(evidence.coverage + 0.05);
  if (!std::isfinite(logit)) return 0.0;
  return logistic(logit) * confidence_of_filters(matches);
}

}  // namespace weft::solvers
