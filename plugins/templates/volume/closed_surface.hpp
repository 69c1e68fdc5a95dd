// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>

namespace weft::volume {

/// The surface of a solid object.
struct ClosedSurface {
  Points3 vertices_m;  ///< [V,3] m, template frame
  Faces faces;         ///< [F,3] counter-clockwise from outside, of welded vertices
  int parts = 0;       ///< [] that share no edge
  double volume_m3 = 0.0;
};

/// The welded surface of a template. Fails unless it is closed: each edge has two faces, which walk
/// it in opposite directions, and the volume that they enclose is positive.
Result<ClosedSurface> closed_surface_of(const Template& templ);

}  // namespace weft::volume
