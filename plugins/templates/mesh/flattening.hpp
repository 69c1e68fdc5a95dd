// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surface.hpp"

namespace weft::mesh {

/// Texture coordinates [V,2], 0 to 1 with v upwards, of a surface without any. ARAP flattens it as
/// rigidly as possible (Liu et al., A local/global approach to mesh parameterization, SGP 2008),
/// exactly where the surface is developable. The image covers the smallest rectangle around it,
/// upright as the file's y axis is (its z axis backwards, for a horizontal surface). Refuses
/// surfaces that are not a disc: closed surfaces, several parts, holes.
Result<Points2> flattened(const MeshFile& file, const Surface& surface);

}  // namespace weft::mesh
