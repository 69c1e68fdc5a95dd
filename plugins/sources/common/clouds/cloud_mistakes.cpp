// SPDX-License-Identifier: Apache-2.0
#include <weft/core/index.hpp>

#include "common/clouds/cloud_file.hpp"

namespace weft::sources {

std::optional<std::string> mistake_in_point(const Eigen::Vector3d& point_m) {
  if (!point_m.allFinite()) {
    return "a point must have three finite numbers: remove the points that were not measured";
  }
  if (point_m.z() > 0.0) return std::nullopt;
  return "z must be positive, since the camera looks along +z: remove the points that were not "
         "measured, or move the cloud into the camera's frame";
}

std::optional<std::string> mistake_in_face(const std::array<std::int64_t, 3>& corners,
                                           std::size_t points) {
  for (const std::int64_t corner : corners) {
    if (corner >= 0 && to_index(corner) < points) continue;
    return "the face uses point " + std::to_string(corner) + ", but the file has " +
           std::to_string(points) + ", counted from 0: correct the index";
  }
  return std::nullopt;
}

Error no_points(const std::string& path) {
  return {Errc::invalid_data, path + ": holds no points: remove the file or write it again", {}};
}

}  // namespace weft::sources
