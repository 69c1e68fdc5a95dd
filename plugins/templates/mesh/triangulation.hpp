// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh_file.hpp"

namespace weft::mesh {

/// Cuts those polygons anew whose fan is wrong: triangles of it that turn the other way or have no
/// area. Each such polygon is seen along its normal (Newell) and its ears are cut off, the one with
/// the largest least angle first (G. H. Meisters, Polygons have ears, 1975). Triangles of a polygon
/// are neighbours in `file.faces` and have the same `count`. Refuses polygons that cross
/// themselves.
Result<void> cut_polygons(MeshFile& file);

}  // namespace weft::mesh
