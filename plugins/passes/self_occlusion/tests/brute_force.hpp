// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <vector>
#include <weft/geometry/types.hpp>

namespace weft::self_occlusion {

/// True if the segment from the camera to `slack_m` before the point meets a triangle (Moeller and
/// Trumbore, 1997), in double precision, with every triangle.
inline bool is_hidden(const Points3View& vertices_m, const FacesView& faces,
                      const Eigen::Vector3d& point_m, double slack_m) {
  const double end = 1.0 - slack_m / point_m.norm();
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Eigen::Vector3d a = vertices_m.row(faces(f, 0));
    const Eigen::Vector3d ab = vertices_m.row(faces(f, 1)).transpose() - a;
    const Eigen::Vector3d ac = vertices_m.row(faces(f, 2)).transpose() - a;
    const Eigen::Vector3d p = point_m.cross(ac);
    const double determinant = ab.dot(p);
    if (determinant == 0.0) continue;
    const double u = -a.dot(p) / determinant;
    const Eigen::Vector3d q = (-a).cross(ab);
    const double v = point_m.dot(q) / determinant, t = ac.dot(q) / determinant;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 1e-4 && t < end) return true;
  }
  return false;
}

}  // namespace weft::self_occlusion
