// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <weft/core/result.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/solid/tetrahedra.hpp>
#include <weft/geometry/solid/welding.hpp>

namespace weft {

/// Checks the welding and the tetrahedra of a template whose surface is valid. A template without
/// them is valid.
inline Result<void> validate_solid(const Template& templ) {
  const auto vertices_m = templ.vertices_m.matrix<3>();
  if (templ.welded_vertex.present()) {
    auto valid = validate_welding(vertices_m, templ.faces.matrix<3>(), templ.welded_vertex);
    if (!valid) return valid;
  }
  const bool has[] = {templ.nodes_m.present(), templ.tetrahedra.present(),
                      templ.vertex_tetrahedron.present(), templ.vertex_barycentric.present()};
  constexpr const char* kNames[] = {"nodes_m", "tetrahedra", "vertex_tetrahedron",
                                    "vertex_barycentric"};
  for (std::size_t i = 1; i < 4; ++i) {
    if (has[i] == has[0]) continue;
    return detail::bad_mesh("the template has " + std::string(kNames[has[i] ? i : 0]) +
                            " without " + kNames[has[i] ? 0 : i] +
                            ": give all four arrays of a solid object (nodes_m, tetrahedra, "
                            "vertex_tetrahedron, vertex_barycentric), or none");
  }
  if (!templ.is_solid()) return {};
  const auto nodes_m = templ.nodes_m.matrix<3>();
  const auto tetrahedra = templ.tetrahedra.matrix<4>();
  if (auto valid = validate_tetrahedra(nodes_m, tetrahedra); !valid) return valid;
  return validate_embedding(vertices_m, nodes_m, tetrahedra, templ.vertex_tetrahedron,
                            templ.vertex_barycentric);
}

}  // namespace weft
