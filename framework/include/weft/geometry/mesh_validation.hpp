// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/result.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// Signed area of a face in the plane with u right and v down: half of det(m1 - m0, m2 - m0).
/// Negative if the face is counter-clockwise in the camera image, which is the orientation of Weft.
inline double signed_area_px2(const Points2View& flat_px, const FacesView& faces,
                              Eigen::Index face) {
  const Eigen::Vector2d origin = flat_px.row(faces(face, 0));
  const Eigen::Vector2d a = flat_px.row(faces(face, 1)).transpose() - origin;
  const Eigen::Vector2d b = flat_px.row(faces(face, 2)).transpose() - origin;
  return 0.5 * (a.x() * b.y() - a.y() * b.x());
}

/// Area of a face in the squared unit of the vertices.
inline double face_area(const Points3View& vertices, const FacesView& faces, Eigen::Index face) {
  const Eigen::Vector3d origin = vertices.row(faces(face, 0));
  const Eigen::Vector3d a = vertices.row(faces(face, 1)).transpose() - origin;
  const Eigen::Vector3d b = vertices.row(faces(face, 2)).transpose() - origin;
  return 0.5 * a.cross(b).norm();
}

/// Smallest area of a valid face: 1e-12 of the squared diagonal of the bounding box.
template <class Derived>
double smallest_area(const Eigen::MatrixBase<Derived>& vertices) {
  const Eigen::Matrix<double, 1, Derived::ColsAtCompileTime> extent =
      vertices.colwise().maxCoeff() - vertices.colwise().minCoeff();
  return 1e-12 * extent.squaredNorm();
}

namespace detail {

template <class Derived>
Result<void> check_finite(const Eigen::MatrixBase<Derived>& vertices) {
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    if (!vertices.row(v).allFinite()) {
      return bad_mesh("vertex " + std::to_string(v) + " is not finite: correct its coordinates");
    }
  }
  return {};
}

inline Result<void> check_isolated(const FacesView& faces, Eigen::Index vertex_count) {
  std::vector<bool> used(to_index(vertex_count), false);
  for (const std::int32_t v : faces.reshaped()) used[to_index(v)] = true;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) {
      return bad_mesh("vertex " + std::to_string(v) + " belongs to no face: remove it");
    }
  }
  return {};
}

inline Error zero_area(Eigen::Index face) {
  return bad_mesh(face_name(face) + " has no area: remove it or separate its vertices");
}

}  // namespace detail

/// Checks a surface: at least one face, indices in range, at most two faces per edge, no isolated
/// vertex, finite vertices, no degenerate face. The error describes the first violation.
inline Result<void> validate_mesh(const Points3View& vertices, const FacesView& faces) {
  if (faces.rows() == 0) return detail::bad_mesh("the mesh has no faces: give at least one");
  if (auto built = build_topology(faces, vertices.rows()); !built) return built.error();
  if (auto checked = detail::check_isolated(faces, vertices.rows()); !checked) return checked;
  if (auto checked = detail::check_finite(vertices); !checked) return checked;
  const double least = smallest_area(vertices);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    worked_in_loop(f, 2);
    if (!(face_area(vertices, faces, f) > least)) return detail::zero_area(f);
  }
  return {};
}

/// Checks the flat mesh of a valid surface: finite, no degenerate face, every face
/// counter-clockwise in the camera image (`signed_area_px2` < 0).
inline Result<void> validate_flat_mesh(const Points2View& flat_px, const FacesView& faces) {
  if (auto checked = check_face_indices(faces, flat_px.rows()); !checked) return checked;
  if (auto checked = detail::check_finite(flat_px); !checked) return checked;
  if (flat_px.rows() == 0) return {};
  const double least = smallest_area(flat_px);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    worked_in_loop(f, 2);
    const double area = signed_area_px2(flat_px, faces, f);
    if (!(std::abs(area) > least)) return detail::zero_area(f);
    if (area > 0.0) {
      return detail::bad_mesh(detail::face_name(f) +
                              " is flipped in the texture (clockwise as the camera sees it): swap "
                              "two of its vertices, or unfold the texture coordinates");
    }
  }
  return {};
}

}  // namespace weft
