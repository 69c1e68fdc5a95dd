// SPDX-License-Identifier: Apache-2.0
#include "agreement.hpp"

#include <algorithm>
#include <cmath>
#include <weft/geometry/barycentric.hpp>

namespace weft::solvers {
namespace {

constexpr double kAgreeingPx = 3.0;

int agrees(const Pinhole& camera, const Eigen::Vector3d& place_m, const Eigen::Vector2d& seen_px) {
  return (project(camera, place_m) - seen_px).norm() < kAgreeingPx ? 1 : 0;
}

}  // namespace

Agreement agreement(const Correspondences& matches, const Faces& faces, const Pinhole& camera,
                    const Points3& vertices_m) {
  Agreement result;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    if (matches.kept(i) == 0) continue;
    ++result.kept;
    if (matches.face(i) < 0) continue;
    const Eigen::Vector3d weights = matches.barycentrics.matrix<3>().row(i);
    result.agreeing += agrees(camera, interpolate(vertices_m, faces, matches.face(i), weights),
                              matches.image_px.matrix<2>().row(i));
  }
  return result;
}

Agreement agreement(const Sightlines& lines, const Faces& faces, const Pinhole& camera,
                    const Points3& vertices_m) {
  Agreement result;
  for (std::int64_t i = 0; i < lines.count(); ++i) {
    if (lines.weight(i) == 0.0) continue;
    ++result.kept;
    const Eigen::Vector3d weights = lines.barycentrics.matrix<3>().row(i);
    const Eigen::Vector3d place_m = lines.vertex(i) >= 0
                                        ? Eigen::Vector3d(vertices_m.row(lines.vertex(i)))
                                        : interpolate(vertices_m, faces, lines.face(i), weights);
    result.agreeing += agrees(camera, place_m, lines.pixel_px.matrix<2>().row(i));
  }
  return result;
}

double confidence_of_filters(const std::optional<Correspondences>& matches) {
  if (!matches || !matches->confidence.present()) return 1.0;
  return std::clamp(*matches->confidence.data(), 0.0, 1.0);
}

double logistic(double logit) { return 1.0 / (1.0 + std::exp(-logit)); }

}  // namespace weft::solvers
