// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// Where vertices of one mesh lie on another.
struct PlacesOnMesh {
  Array<std::int32_t> face;  ///< [V] index, -1 where it is beside that mesh
  Array<double> weights;     ///< [V,3] of the corners of that face, sum 1; 0 where there is none
};

/// Where the vertices of `from` lie on the mesh of `onto`, by their places in the texture, which
/// both share. Beyond a border, weights continue the nearest face, up to half a mean edge away.
Result<PlacesOnMesh> places_on_mesh(const Template& from, const Template& onto);

/// The template with a texture that ends `margin_px` beside the object.
Template with_cropped_texture(const Template& templ, double margin_px);

}  // namespace weft
