// SPDX-License-Identifier: Apache-2.0
#include "evidence.hpp"

#include <cmath>
#include <cstddef>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/mesh_validation.hpp>

namespace weft::self_occlusion {
namespace {

/// px^2 of a face in the image times the squared cosine of its slant; 0 where it is not in view.
double exposure_px2(const Scene& scene, const Points2& pixels, Eigen::Index face) {
  const double cosine = scene.cosines[static_cast<std::size_t>(face)];
  const double area_px2 = std::abs(signed_area_px2(pixels, scene.faces, face));
  return cosine > 0.0 && std::isfinite(area_px2) ? cosine * cosine * area_px2 : 0.0;
}

bool two_agree(const std::vector<Eigen::Vector2d>& offsets_px, double tolerance_px) {
  for (std::size_t i = 0; i < offsets_px.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if ((offsets_px[i] - offsets_px[j]).norm() <= tolerance_px) return true;
    }
  }
  return false;
}

}  // namespace

Evidence gather_evidence(const Scene& scene, const Camera& camera, const Correspondences& matches,
                         double tolerance_px) {
  const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  const auto vertex_count = static_cast<std::size_t>(scene.vertices_m.rows());
  std::vector<int> in_face(static_cast<std::size_t>(scene.faces.rows()), 0);
  std::vector<std::vector<Eigen::Vector2d>> nearest(vertex_count);
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    const std::int32_t face = matches.face(i);
    if (matches.kept(i) == 0 || face < 0) continue;
    ++in_face[static_cast<std::size_t>(face)];
    const Eigen::Vector3d weights = matches.barycentrics.matrix<3>().row(i);
    const Eigen::Vector3d point_m = interpolate(scene.vertices_m, scene.faces, face, weights);
    const Eigen::Vector2d image_px = matches.image_px.matrix<2>().row(i);
    Eigen::Index corner = 0;
    weights.maxCoeff(&corner);
    nearest[static_cast<std::size_t>(scene.faces(face, corner))].push_back(
        image_px - project(pinhole, point_m));
  }
  const Points2 pixels = project_points(pinhole, scene.vertices_m);
  std::vector<double> exposure(in_face.size());
  double counted = 0.0, exposed_px2 = 0.0;
  for (std::size_t f = 0; f < in_face.size(); ++f) {
    exposure[f] = exposure_px2(scene, pixels, static_cast<Eigen::Index>(f));
    if (in_face[f] == 0 || exposure[f] == 0.0) continue;
    counted += in_face[f];
    exposed_px2 += exposure[f];
  }
  const double rate_per_px2 = exposed_px2 > 0.0 ? counted / exposed_px2 : 0.0;
  Evidence evidence;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    int found = 0;
    double around_px2 = 0.0;
    for (const std::int32_t face : scene.around[static_cast<Eigen::Index>(v)]) {
      found += in_face[static_cast<std::size_t>(face)];
      around_px2 += exposure[static_cast<std::size_t>(face)];
    }
    evidence.confirmed.push_back(two_agree(nearest[v], tolerance_px) ? 1 : 0);
    evidence.matches.push_back(found);
    evidence.expected.push_back(rate_per_px2 * around_px2);
  }
  return evidence;
}

}  // namespace weft::self_occlusion
