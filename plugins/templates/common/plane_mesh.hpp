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

/// Fills an outline with triangles: constrained Delaunay with the outline's sides as constraints,
/// refined until angles are above 20.7 degrees and edges about `spacing_px` long (Shewchuk's bound
/// B = 0.125), then evened out in `smoothing_rounds`, in each of which every inner vertex moves to
/// the centroid of the faces around it. Fails on an outline that crosses itself.
Result<PlaneMesh> fill_outline(const Outline& outline, double spacing_px, int smoothing_rounds);

}  // namespace weft::outline
