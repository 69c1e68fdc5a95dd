// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <weft/core/result.hpp>
#include <weft/data/sightlines.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// Checks that sightlines fit a mesh: vertices below `vertex_count`, a face of the mesh if the
/// vertex is -1, finite unit rays (within 1e-6), finite weights >= 0. The error describes the first
/// violation.
inline Result<void> check_sightlines(const Sightlines& sightlines, Eigen::Index vertex_count,
                                     Eigen::Index face_count) {
  const auto mistake = [](std::int64_t i, const std::string& what) {
    return Error{Errc::invalid_data, "sightline " + std::to_string(i) + " " + what};
  };
  for (std::int64_t i = 0; i < sightlines.count(); ++i) {
    const std::int32_t vertex = sightlines.vertex(i), face = sightlines.face(i);
    if (vertex < -1 || vertex >= vertex_count) {
      return mistake(i, "names vertex " + std::to_string(vertex) + " of a template with " +
                            std::to_string(vertex_count) + ": use one template throughout");
    }
    if (vertex < 0 && (face < 0 || face >= face_count)) {
      return mistake(i, "lies in face " + std::to_string(face) + " of a template with " +
                            std::to_string(face_count) + ": use one template throughout");
    }
    double norm2 = 0.0, weights = 0.0;
    for (int k = 0; k < 3; ++k) {
      norm2 += sightlines.ray(i, k) * sightlines.ray(i, k);
      weights += vertex < 0 ? sightlines.barycentrics(i, k) : 0.0;
    }
    if (!(std::abs(norm2 - 1.0) <= 2e-6)) return mistake(i, "has no unit ray: normalise it");
    if (!std::isfinite(weights)) return mistake(i, "has no finite barycentric weights");
    if (!(sightlines.weight(i) >= 0.0) || !std::isfinite(sightlines.weight(i))) {
      return mistake(i, "has a weight that is negative or not finite");
    }
  }
  return {};
}

}  // namespace weft
