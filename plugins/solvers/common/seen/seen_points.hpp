// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>

namespace weft::solvers {

/// A point of the mesh and where it was seen.
struct SeenPoint {
  std::array<std::int32_t, 3> corners{};  ///< [3] vertices of its face
  Eigen::Vector3d weights;                ///< [3] in the face, sum 1
  Eigen::Vector2d seen_px;                ///< [2] px of the image

  /// Where it is when the vertices are at `vertices` [V,3], in their unit.
  Eigen::Vector3d on(const Points3View& vertices) const {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      point += weights[k] * vertices.row(corners[static_cast<std::size_t>(k)]).transpose();
    }
    return point;
  }
};

/// The kept matches that lie on the mesh. Fails on faces that the template lacks and on numbers
/// that are not finite; no_result for fewer than `fewest` and for points on a line at rest.
Result<std::vector<SeenPoint>> seen_points(const Correspondences& matches, const Template& templ,
                                           std::size_t fewest);

/// The two equations R p = 0 [2,3] of a point p that is seen at a pixel,
///     fx X + (cx - u) Z = 0,   fy Y + (cy - v) Z = 0.
/// With p = sum_k b_k X_k they are two rows of the linear system M X = 0 in the vertices (Salzmann
/// et al. 2007). R p is the error in the image times the depth, in px m.
Eigen::Matrix<double, 2, 3> reprojection_rows(const Camera& camera, const Eigen::Vector2d& seen_px);

/// The error of each point [n] px; infinite for one that is not in front of the camera.
std::vector<double> reprojection_errors_px(std::span<const SeenPoint> points, const Camera& camera,
                                           const Points3View& vertices_m);

/// Those that are at most so far off in the image.
std::vector<SeenPoint> points_within(std::span<const SeenPoint> points, const Camera& camera,
                                     const Points3View& vertices_m, double radius_px);

/// m, the distance of a flat frontal surface that appears as large as the points do. Not finite
/// where they coincide in the image, to 1e-6 focal lengths.
double frontal_distance_m(std::span<const SeenPoint> points, const Camera& camera,
                          const Points3View& rest_m);

/// [V] 1 for the vertices of faces with a seen point.
std::vector<std::uint8_t> vertices_seen(std::span<const SeenPoint> points,
                                        Eigen::Index vertex_count);

}  // namespace weft::solvers
