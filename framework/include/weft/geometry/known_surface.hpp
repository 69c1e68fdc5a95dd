// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/result.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/known_points.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// A surface point, sum_k weights[k] X[vertices[k]], that lies within a sphere.
struct KnownSurfacePoint {
  std::int32_t vertex = -1;                ///< [] vertex index, -1 for a point inside a face
  std::int32_t face = -1;                  ///< [] face index, -1 for a vertex
  std::array<std::int32_t, 3> vertices{};  ///< [3] vertex indices; a vertex is repeated three times
  std::array<double, 3> weights{};         ///< [3] sum 1; 1, 0, 0 for a vertex
  Eigen::Vector3d centre_m;                ///< [3] m, camera frame, centre of the sphere
  double radius_m = 0.0;  ///< [] m, radius of the sphere; 0 fixes the point at the centre

  static KnownSurfacePoint at_vertex(std::int32_t vertex, const Eigen::Vector3d& centre_m,
                                     double radius_m) {
    return {vertex, -1, {vertex, vertex, vertex}, {1.0, 0.0, 0.0}, centre_m, radius_m};
  }

  /// The position on a shape [V,3] m, camera frame.
  Eigen::Vector3d on(const Points3View& vertices_m) const {
    if (vertex >= 0) return vertices_m.row(vertex).transpose();
    Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      point_m += weights[k] * vertices_m.row(vertices[k]).transpose();
    }
    return point_m;
  }
};

namespace detail {

/// The face of a flat mesh for which the smallest weight of `point_px` is largest. This is the face
/// that contains the point, or the nearest one. Returns -1 if a weight would be below -1/2.
inline std::int32_t face_around(const Eigen::Vector2d& point_px, const Points2View& flat_px,
                                const FacesView& faces, Eigen::Vector3d& weights) {
  constexpr double kLeastWeight = -0.5;
  std::int32_t found = -1;
  double largest = kLeastWeight;
  for (std::int32_t f = 0; f < faces.rows(); ++f) {
    worked_in_loop(f, 3);
    const Eigen::Vector3d in_face = barycentric_weights(
        point_px, flat_px.row(faces(f, 0)), flat_px.row(faces(f, 1)), flat_px.row(faces(f, 2)));
    if (!(in_face.minCoeff() > largest)) continue;
    largest = in_face.minCoeff();
    weights = in_face;
    found = f;
  }
  return found;
}

/// Sets the corners and the weights of a point in its face. A point within 1e-6 of a vertex becomes
/// that vertex.
inline void put_in_face(const Eigen::Vector3d& weights, const FacesView& faces,
                        KnownSurfacePoint& point) {
  for (int k = 0; k < 3; ++k) {
    constexpr double kWhole = 1.0 - 1e-6;
    if (weights[k] > kWhole) {
      point = KnownSurfacePoint::at_vertex(faces(point.face, k), point.centre_m, point.radius_m);
      return;
    }
    point.vertices[to_index(k)] = faces(point.face, k);
    point.weights[to_index(k)] = weights[k];
  }
}

/// Puts a point given by template_xy_m on the mesh. A point within 1e-6 of a vertex becomes that
/// vertex.
inline Result<void> place_on_mesh(const Eigen::Vector2d& xy_m, const std::string& name,
                                  const Template& templ, KnownSurfacePoint& point) {
  if (!templ.m_per_px.present()) {
    return Error{Errc::invalid_data,
                 name + " is a point of the template, which is not flat: name a vertex"};
  }
  const Eigen::Vector2d pitch(templ.m_per_px(0), templ.m_per_px(1));
  const auto faces = templ.faces.matrix<3>();
  Eigen::Vector3d weights;
  point.face = face_around(xy_m.cwiseQuotient(pitch), templ.flat_px.matrix<2>(), faces, weights);
  if (point.face < 0) {
    return Error{Errc::invalid_data, name + " is at (" + std::to_string(1e3 * xy_m.x()) + ", " +
                                         std::to_string(1e3 * xy_m.y()) +
                                         ") mm, beside the template"};
  }
  put_in_face(weights, faces, point);
  return {};
}

/// Puts a point given by face and barycentrics on the mesh. A point within 1e-6 of a vertex becomes
/// that vertex.
inline Result<void> place_in_face(const KnownPoints& known, std::int64_t p, const std::string& name,
                                  const Template& templ, KnownSurfacePoint& point) {
  constexpr double kSumTolerance = 1e-6, kLeastWeight = -0.5;
  const auto faces = templ.faces.matrix<3>();
  if (known.face(p) >= faces.rows()) {
    return Error{Errc::invalid_data, name + " names face " + std::to_string(known.face(p)) +
                                         " of a template with " + std::to_string(faces.rows())};
  }
  if (!known.barycentrics.present()) {
    return Error{Errc::invalid_data,
                 name +
                     " names a face, but 'barycentrics' is absent: add three weights for each "
                     "point"};
  }
  const Eigen::Vector3d weights = known.barycentrics.matrix<3>().row(p).transpose();
  if (!weights.allFinite() || std::abs(weights.sum() - 1.0) > kSumTolerance ||
      weights.minCoeff() < kLeastWeight) {
    return Error{Errc::invalid_data, name + " has the barycentrics " + std::to_string(weights.x()) +
                                         ", " + std::to_string(weights.y()) + ", " +
                                         std::to_string(weights.z()) +
                                         ": their sum must be 1, and each at least -0.5"};
  }
  point.face = known.face(p);
  put_in_face(weights, faces, point);
  return {};
}

}  // namespace detail

/// The known points on a template's mesh. A negative radius becomes `own_radius_m`. Fails on a
/// missing vertex or face, on weights whose sum is not 1, and on non-finite numbers. Also fails on
/// a point beside a flat template, and on a point without vertex and face on a curved one. The
/// error gives the point.
inline Result<std::vector<KnownSurfacePoint>> known_surface_points(const KnownPoints& known,
                                                                   const Template& templ,
                                                                   double own_radius_m) {
  std::vector<KnownSurfacePoint> points;
  const Eigen::Index vertex_count = templ.vertices_m.rows();
  for (std::int64_t p = 0; p < known.count(); ++p) {
    const std::string name = "known point " + std::to_string(p);
    const Eigen::Vector3d centre_m = known.points_m.matrix<3>().row(p).transpose();
    const std::int32_t vertex = known.vertex(p);
    if (!centre_m.allFinite() || !std::isfinite(known.radius_m(p))) {
      return Error{Errc::invalid_data, name + " is not finite: leave it out"};
    }
    const bool in_face = vertex == -1 && known.face.present() && known.face(p) >= 0;
    const bool is_placed = vertex >= 0 || in_face || known.template_xy_m.present();
    if (vertex >= vertex_count || vertex < -1 || !is_placed) {
      return Error{Errc::invalid_data, name + " names vertex " + std::to_string(vertex) +
                                           " of a template with " + std::to_string(vertex_count)};
    }
    const double radius_m = known.radius_m(p) < 0.0 ? own_radius_m : known.radius_m(p);
    points.push_back(KnownSurfacePoint::at_vertex(vertex, centre_m, radius_m));
    if (vertex >= 0) continue;
    if (in_face) {
      auto placed = detail::place_in_face(known, p, name, templ, points.back());
      if (!placed) return placed.error();
      continue;
    }
    const Eigen::Vector2d xy_m = known.template_xy_m.matrix<2>().row(p).transpose();
    auto placed = detail::place_on_mesh(xy_m, name, templ, points.back());
    if (!placed) return placed.error();
  }
  return points;
}

}  // namespace weft
