// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

#include "polygon.hpp"

namespace weft::outline {

struct PlaneMesh {
  Points2 flat_px;  ///< [V,2] px, by v and then by u
  Faces faces;      ///< [F,3] counter-clockwise as the camera sees them (v grows downwards)
};

/// Fills an outline with triangles by constrained Delaunay, with the outline's sides as
/// constraints. Refinement gives angles above 20.7 degrees and edges about `spacing_px` long
/// (Shewchuk's bound B = 0.125). Then `smoothing_rounds` follow: in each, every inner vertex moves
/// to the centroid of the faces around it. Fails on an outline that crosses itself.
Result<PlaneMesh> fill_outline(const Outline& outline, double spacing_px, int smoothing_rounds);

}  // namespace weft::outline
