// SPDX-License-Identifier: Apache-2.0
#include "solid/solid_rest.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>

#include "film/welding.hpp"
#include "rest_sheet.hpp"

namespace weft::frex {
namespace {

/// Vertices [V,3] m with twins at exactly one place, so that seams stay closed.
Points3 joined(const Points3& vertices_m, const std::vector<std::int32_t>& first) {
  Points3 places_m = vertices_m;
  for (std::size_t v = 0; v < first.size(); ++v) {
    places_m.row(static_cast<Eigen::Index>(v)) = vertices_m.row(first[v]);
  }
  return places_m;
}

/// Rows are the axes of the bounding box: the longest, the middle and the shortest side.
Eigen::Matrix3d axes_of(const Eigen::RowVector3d& extent) {
  std::array<Eigen::Index, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index i, Eigen::Index j) { return extent[i] > extent[j]; });
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
  for (Eigen::Index k = 0; k < 3; ++k) axes(k, order[to_index(k)]) = 1.0;
  return axes.determinant() < 0.0 ? (Eigen::Vector3d(1.0, 1.0, -1.0).asDiagonal() * axes).eval()
                                  : axes;
}

/// The derivative [3,2] of the place by the texture position, times the area in the texture.
Eigen::Matrix<double, 3, 2> area_times_slope(const Points3& places_m, const Points2& uv_px,
                                             const Eigen::RowVector3i& face) {
  Eigen::Matrix<double, 3, 2> sides;
  Eigen::Matrix2d in_texture;
  for (int k = 0; k < 2; ++k) {
    sides.col(k) = (places_m.row(face[k + 1]) - places_m.row(face[0])).transpose();
    in_texture.col(k) = (uv_px.row(face[k + 1]) - uv_px.row(face[0])).transpose();
  }
  Eigen::Matrix2d adjugate;
  adjugate << in_texture(1, 1), -in_texture(0, 1), -in_texture(1, 0), in_texture(0, 0);
  return in_texture.determinant() < 0.0 ? (-sides * adjugate).eval() : (sides * adjugate).eval();
}

/// A turn by pi about axes of the box. The textured side of an open surface comes before the
/// camera, and the texture there stands upright as far as the longest side lies horizontally.
Eigen::Vector3d facing(const Points3& places_m, const Points2& uv_px, const Faces& faces) {
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  double area = 0.0;
  std::vector<double> towards(to_index(faces.rows()));
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Eigen::RowVector3d a = places_m.row(faces(f, 0));
    const Eigen::RowVector3d normal = (Eigen::RowVector3d(places_m.row(faces(f, 1))) - a)
                                          .cross(Eigen::RowVector3d(places_m.row(faces(f, 2))) - a);
    sum += normal;
    area += normal.norm();
    towards[to_index(f)] = normal.z();
  }
  constexpr double kOpen = 1e-6;
  // Faces are counter-clockwise from outside; the camera is at -z.
  const double side = sum.z() > kOpen * area ? -1.0 : 1.0;
  double upright = 0.0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    if (!(side * towards[to_index(f)] < 0.0)) continue;
    const auto slope = area_times_slope(places_m, uv_px, faces.row(f));
    upright += slope(0, 0) + side * slope(1, 1);  // the turn that changes the side inverts y
  }
  return upright < 0.0 ? Eigen::Vector3d(-1.0, -side, side) : Eigen::Vector3d(1.0, side, side);
}

}  // namespace

Result<SolidRest> solid_of(const Template& object, double edge_m) {
  if (auto legal = check_pitch(object); !legal) return legal.error();
  const auto first = first_at_place(object);
  if (!first) return first.error();
  const Points2 uv_px = object.flat_px.matrix<2>();
  const Faces faces = object.faces.matrix<3>();
  const Points3 vertices_m = joined(object.vertices_m.matrix<3>(), *first);
  if (auto legal = check_face_indices(faces, vertices_m.rows()); !legal) return legal.error();
  const Eigen::RowVector3d low = vertices_m.colwise().minCoeff();
  const Eigen::RowVector3d high = vertices_m.colwise().maxCoeff();
  const Eigen::Matrix3d axes = axes_of(high - low);
  Points3 places_m = (vertices_m.rowwise() - 0.5 * (low + high)) * axes.transpose();
  const Eigen::Vector3d turn = facing(places_m, uv_px, faces);
  places_m = places_m * turn.asDiagonal();
  constexpr double kEdgesInDiagonal = 40.0;
  const double longest_m = edge_m > 0.0 ? edge_m : (high - low).norm() / kEdgesInDiagonal;
  auto surface = refined(places_m, uv_px, faces, longest_m);
  if (!surface) return surface.error();
  return SolidRest{*std::move(surface), object.m_per_px.matrix<1>().transpose(),
                   (axes * (high - low).transpose()).cwiseAbs()};
}

}  // namespace weft::frex
