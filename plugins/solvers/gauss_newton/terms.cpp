// SPDX-License-Identifier: Apache-2.0
#include "terms.hpp"

#include <weft/core/index.hpp>

namespace weft::gauss_newton {

HingeSlopes angle_slopes(const Hinge& hinge, const Points3& normals, const Points3& vertices_m) {
  const auto at = [&](std::size_t k) -> Eigen::Vector3d {
    return vertices_m.row(hinge.vertex[k]).transpose();
  };
  HingeSlopes slopes;
  slopes.fill(Eigen::Vector3d::Zero());
  const Eigen::Vector3d edge = at(1) - at(0);
  const Eigen::Vector3d of_c = normals.row(hinge.face[0]), of_d = normals.row(hinge.face[1]);
  const double length2 = edge.squaredNorm(), c2 = of_c.squaredNorm(), d2 = of_d.squaredNorm();
  if (!(length2 > 1e-18 && c2 > 1e-36 && d2 > 1e-36)) return slopes;
  // A corner that is lifted by its height over the edge turns its face by one.
  const double length = std::sqrt(length2);
  slopes[2] = length / c2 * of_c;
  slopes[3] = length / d2 * of_d;
  const double along_c = (at(2) - at(0)).dot(edge) / length2;
  const double along_d = (at(3) - at(0)).dot(edge) / length2;
  slopes[0] = (along_c - 1.0) * slopes[2] + (along_d - 1.0) * slopes[3];
  slopes[1] = -along_c * slopes[2] - along_d * slopes[3];
  return slopes;
}

void add_square(const Hinge& hinge, const HingeSlopes& slopes, BlockMatrix& matrix) {
  std::size_t k = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    matrix.diagonal[to_index(hinge.vertex[i])] += slopes[i] * slopes[i].transpose();
    for (std::size_t j = i + 1; j < 4; ++j, ++k) {
      Eigen::Matrix3d& block = matrix.coupling[to_index(hinge.coupling[k])];
      const bool in_order = hinge.vertex[i] < hinge.vertex[j];
      block += slopes[in_order ? i : j] * slopes[in_order ? j : i].transpose();
    }
  }
}

void add_square(const MeshModel& mesh, const KnownSurfacePoint& point, const Eigen::Matrix3d& block,
                BlockMatrix& matrix) {
  if (point.vertex >= 0) {
    matrix.diagonal[to_index(point.vertex)] += block;
    return;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const double own = point.weights[k], next = point.weights[(k + 1) % 3];
    matrix.diagonal[to_index(point.vertices[k])] += own * own * block;
    const std::int32_t edge = mesh.face_arcs(point.face, static_cast<Eigen::Index>(k));
    matrix.coupling[to_index(mesh.edges[to_index(edge)].coupling)] += own * next * block;
  }
}

void add_square(const Arc& arc, const Eigen::Matrix3d& block, BlockMatrix& matrix) {
  matrix.diagonal[to_index(arc.i)] += block;
  matrix.diagonal[to_index(arc.j)] += block;
  matrix.coupling[to_index(arc.coupling)] -= block;
}

}  // namespace weft::gauss_newton
