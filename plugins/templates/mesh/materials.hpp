// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mesh_file.hpp"

namespace weft::mesh {

/// Materials that statements of an OBJ file name, and the libraries that define them.
struct Materials {
  struct Used {
    std::string name;
    std::int64_t faces = 0;
  };
  std::vector<Used> used;              ///< in their order
  std::vector<std::string> libraries;  ///< as the file has them

  /// Sets the material of the next faces.
  void use(std::string_view name);
  void count_face() {
    if (!used.empty()) ++used[current].faces;
  }
  std::size_t current = 0;
};

/// Refuses faces with several images, by the libraries beside the file; notes several materials
/// that may share one.
Result<void> check_materials(Materials materials, MeshFile& file);

}  // namespace weft::mesh
