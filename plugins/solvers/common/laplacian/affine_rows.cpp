// SPDX-License-Identifier: Apache-2.0
#include "common/laplacian/affine_rows.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>
#include <weft/core/stop_check.hpp>

namespace weft::solvers {
namespace {

using Entries = std::vector<Eigen::Triplet<double>>;

/// The weights w of D + 2 points in D dimensions with sum w = 0, sum w x = 0 and |w| = 1.
template <int D>
Eigen::Matrix<double, D + 2, 1> affine_dependency(const Eigen::Matrix<double, D, D + 2>& points) {
  Eigen::Matrix<double, D + 2, D + 2> square = Eigen::Matrix<double, D + 2, D + 2>::Zero();
  const Eigen::Matrix<double, D, D + 2> centred = points.colwise() - points.rowwise().mean();
  square.template topRows<D>() = centred / centred.norm();
  square.row(D).setOnes();
  const Eigen::JacobiSVD<decltype(square)> svd(square, Eigen::ComputeFullV);
  return svd.matrixV().col(D + 1);
}

/// Two faces with the edge from b to c, laid into a plane on either side of it; a and d are their
/// other corners.
Eigen::Matrix<double, 2, 4> unfolded(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                     const Eigen::Vector3d& c, const Eigen::Vector3d& d) {
  const double edge = (c - b).norm();
  const Eigen::Vector3d along = (c - b) / edge;
  const double a_x = along.dot(a - b), d_x = along.dot(d - b);
  const double a_y = along.cross(a - b).norm(), d_y = along.cross(d - b).norm();
  Eigen::Matrix<double, 2, 4> plane;
  plane << a_x, 0.0, edge, d_x, -a_y, 0.0, 0.0, d_y;
  return plane;
}

bool is_flat(const Points3View& rest_m) {
  constexpr double kFlat = 0.01;  // share of the distance of the furthest vertex from the middle
  const Points3 centred = rest_m.rowwise() - rest_m.colwise().mean();
  const double reach = centred.rowwise().norm().maxCoeff();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(centred.transpose() * centred);
  return (centred * axes.eigenvectors().col(0)).cwiseAbs().maxCoeff() <= kFlat * reach;
}

/// Writes rows for a mesh [V,3] to which two virtual vertices for each face are added.
class Rows {
 public:
  Rows(const Points3View& rest_m, const FacesView& faces) : rest_m_(rest_m), faces_(faces) {}

  void add_flat_pair(const std::array<std::int32_t, 4>& pair) {
    add<2>(pair, unfolded(vertex(pair[0]), vertex(pair[1]), vertex(pair[2]), vertex(pair[3])));
  }

  /// The two tetrahedra of a face.
  void add_face(std::int32_t face) {
    add_solid({faces_(face, 0), faces_(face, 1), faces_(face, 2), virtual_index(face, 0),
               virtual_index(face, 1)});
  }

  /// On each side three tetrahedra around the edge from b to c of two faces: of the first face, of
  /// the edge with both virtual vertices, of the second face.
  void add_edge(const std::array<std::int32_t, 4>& pair, std::int32_t first, std::int32_t second) {
    for (int side = 0; side < 2; ++side) {
      const std::int32_t one = virtual_index(first, side), other = virtual_index(second, side);
      add_solid({pair[0], pair[1], pair[2], one, other});
      add_solid({one, pair[1], pair[2], other, pair[3]});
    }
  }

  Eigen::SparseMatrix<double> matrix(Eigen::Index columns) const {
    Eigen::SparseMatrix<double> result(count_, columns);
    result.setFromTriplets(entries_.begin(), entries_.end());
    return result;
  }

 private:
  Eigen::Vector3d vertex(std::int32_t v) const { return rest_m_.row(v).transpose(); }

  std::int32_t virtual_index(std::int32_t face, int side) const {
    return static_cast<std::int32_t>(rest_m_.rows()) + 2 * face + side;
  }

  /// A vertex, or half an edge in front of the middle of a face or behind it.
  Eigen::Vector3d point(std::int32_t index) const {
    const std::int32_t beyond = index - static_cast<std::int32_t>(rest_m_.rows());
    if (beyond < 0) return vertex(index);
    const std::int32_t face = beyond / 2;
    const Eigen::Vector3d a = vertex(faces_(face, 0)), b = vertex(faces_(face, 1)),
                          c = vertex(faces_(face, 2));
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const double offset = (beyond % 2 == 0 ? 0.5 : -0.5) / std::sqrt(normal.norm());
    return (a + b + c) / 3.0 + offset * normal;
  }

  void add_solid(const std::array<std::int32_t, 5>& indices) {
    Eigen::Matrix<double, 3, 5> points;
    for (int k = 0; k < 5; ++k) points.col(k) = point(indices[static_cast<std::size_t>(k)]);
    add<3>(indices, points);
  }

  template <int D>
  void add(const std::array<std::int32_t, D + 2>& indices,
           const Eigen::Matrix<double, D, D + 2>& points) {
    worked(100);
    const auto weights = affine_dependency<D>(points);
    for (int k = 0; k < D + 2; ++k) {
      entries_.emplace_back(static_cast<int>(count_), indices[static_cast<std::size_t>(k)],
                            weights[k]);
    }
    ++count_;
  }

  const Points3View& rest_m_;
  const FacesView& faces_;
  Entries entries_;
  Eigen::Index count_ = 0;
};

}  // namespace

AffineRows affine_rows(const Points3View& rest_m, const FacesView& faces,
                       const MeshTopology& topology) {
  AffineRows result;
  result.flat = is_flat(rest_m);
  Rows rows(rest_m, faces);
  for (std::int32_t f = 0; f < faces.rows() && !result.flat; ++f) rows.add_face(f);
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    const std::int32_t first = topology.edge_faces(e, 0), second = topology.edge_faces(e, 1);
    if (second < 0) continue;
    const std::int32_t b = topology.edges(e, 0), c = topology.edges(e, 1);
    const std::array<std::int32_t, 4> pair{detail::opposite_vertex(faces, first, b, c), b, c,
                                           detail::opposite_vertex(faces, second, b, c)};
    if (result.flat) {
      rows.add_flat_pair(pair);
    } else {
      rows.add_edge(pair, first, second);
    }
  }
  result.rows = rows.matrix(rest_m.rows() + (result.flat ? 0 : 2 * faces.rows()));
  return result;
}

}  // namespace weft::solvers
