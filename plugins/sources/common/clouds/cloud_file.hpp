// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/array.hpp>

namespace weft::sources {

/// Points of a true surface without known places on the template, or the surface itself.
struct Cloud {
  std::vector<Eigen::Vector3d> points_m;           ///< m, camera frame; at least one, all finite
  std::vector<std::array<std::int32_t, 3>> faces;  ///< triangles over the points, or none
};

/// Reads a PLY file (ascii or binary): x, y and z of its vertices in units of `unit_m`, and its
/// faces. Polygons are cut into fans; all else is ignored. Fails, with line or element, on a value
/// that is not finite and on a point that is not in front of the camera. Also fails on a corner
/// that is not a point, and on a file without points.
Result<Cloud> read_ply_cloud(const std::string& path, double unit_m);

/// Reads a CSV file with the columns X_m, Y_m and Z_m or X_mm, Y_mm and Z_mm in any order. Fails
/// alike, and on any other column.
Result<Cloud> read_csv_cloud(const std::string& path);

/// Reads the arrays `points` (f4 or f8, [P,3], in units of `unit_m`) and, if present, `faces` (i4
/// or i8, [G,3]) of an npz file. Nothing where there is no array `points`. Fails alike.
Result<std::optional<Cloud>> read_npz_cloud(const std::string& path, double unit_m);

/// True if the first line of a CSV file has columns of clouds only. Fails where it cannot be read.
Result<bool> is_csv_cloud(const std::string& path);

/// The error in a point [m, camera frame], and its fix; nothing for a valid one.
std::optional<std::string> mistake_in_point(const Eigen::Vector3d& point_m);
/// The same for a triangle over this many points.
std::optional<std::string> mistake_in_face(const std::array<std::int64_t, 3>& corners,
                                           std::size_t points);
/// The error of a file without points.
Error no_points(const std::string& path);

}  // namespace weft::sources
