// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "remeshing.hpp"

namespace weft::mesh {

/// A piece of a surface whose faces are joined by their sides in the texture.
struct Chart {
  TexturedMesh mesh;
  std::vector<std::vector<std::int32_t>> borders;  ///< closed walks along its vertices
};

/// In the order of their first faces. A vertex at which pieces only touch is one of each.
std::vector<Chart> charts_of(const TexturedMesh& mesh);

}  // namespace weft::mesh
