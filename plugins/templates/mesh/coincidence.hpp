// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/data/array.hpp>
#include <weft/geometry/types.hpp>

#include "mesh_file.hpp"

namespace weft::mesh {

/// Largest difference of two equal places, as a share of the mesh's bounding box diagonal, and of
/// two equal texture coordinates: what rounding to six digits brings.
inline constexpr double kCoincident = 1e-6;

/// For each of the file's positions the first one in the file that is at the same place, see
/// kCoincident. A position is compared with such first ones alone, so that places do not drift.
std::vector<std::int32_t> first_positions(const MeshFile& file);

/// For each corner of each face, 3 f + k, the first corner in the file with the same place (see
/// first_positions) and the same texture coordinates.
std::vector<std::int32_t> first_corners(const MeshFile& file,
                                        const std::vector<std::int32_t>& first_position);

/// Removes faces that have two corners at one place or no area, and gives their number.
std::int64_t remove_faces_without_area(MeshFile& file,
                                       const std::vector<std::int32_t>& first_position);

/// For each vertex [V] the first one with exactly the same coordinates, itself included. Absent
/// where no two vertices share a place: a surface without a seam.
Array<std::int32_t> welded_vertices(const Points3& vertices);

}  // namespace weft::mesh
