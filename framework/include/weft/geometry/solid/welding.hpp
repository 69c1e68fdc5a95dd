// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <weft/core/result.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/array.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// The faces with each vertex replaced by the first one at its place.
inline Faces welded_faces(const FacesView& faces, const Array<std::int32_t>& welded_vertex) {
  Faces welded = faces;
  if (!welded_vertex.present()) return welded;
  for (std::int32_t& v : welded.reshaped()) v = welded_vertex(v);
  return welded;
}

namespace detail {

inline Error bad_entry(const char* array, std::int64_t index, const std::string& sentence) {
  return {Errc::invalid_data, "the template's " + std::string(array) + " at index " +
                                  std::to_string(index) + " " + sentence};
}

/// Largest distance that counts as the same place, as a share of the diagonal.
inline constexpr double kSamePlace = 1e-9;
inline double diagonal_of(const Points3View& points) {
  return (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm();
}

}  // namespace detail

/// Checks `welded_vertex` of a valid surface: indices in range, each vertex names the first one at
/// its place, and the welded surface is manifold.
inline Result<void> validate_welding(const Points3View& vertices, const FacesView& faces,
                                     const Array<std::int32_t>& welded_vertex) {
  constexpr const char* kArray = "welded_vertex";
  const double most = detail::kSamePlace * detail::diagonal_of(vertices);
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    worked_in_loop(v);
    const std::int32_t first = welded_vertex(v);
    if (first < 0 || first > v) {
      return detail::bad_entry(kArray, v,
                               "is " + std::to_string(first) +
                                   ": name the first vertex at the same place, from 0 to " +
                                   std::to_string(v));
    }
    if (welded_vertex(first) != first) {
      return detail::bad_entry(kArray, v,
                               "is " + std::to_string(first) + ", which names vertex " +
                                   std::to_string(welded_vertex(first)) + " itself: name that one");
    }
    const double apart = (vertices.row(v) - vertices.row(first)).norm();
    if (apart <= most) continue;
    return detail::bad_entry(kArray, v,
                             "is " + std::to_string(first) + ", " + std::to_string(1e3 * apart) +
                                 " mm away: weld only vertices at the same place");
  }
  const auto topology = build_topology(welded_faces(faces, welded_vertex), vertices.rows());
  if (topology) return {};
  return detail::bad_mesh("the template's welded_vertex joins vertices so that " +
                          topology.error().message + ", or do not weld these vertices");
}

}  // namespace weft
