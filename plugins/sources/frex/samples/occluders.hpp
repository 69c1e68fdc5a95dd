// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/rng.hpp>
#include <weft/geometry/types.hpp>

#include "backdrop.hpp"
#include "common/scene/sheet_renderer.hpp"

namespace weft::frex {

/// Opaque things before the surface: discs, slabs and fingers. Half of them have the colours of
/// `textured`, which has the size of the image, the others one colour. Each has its middle on the
/// surface. The view has their colours,
/// `depth_m` 0, `uv_px` NaN and hits of another mesh there; the vertices under them, seen at
/// `vertices_px` [V,2], are invisible.
void cover_at_random(int count, const Picture& textured, const Points2& vertices_px, Rng& rng,
                     scene::View& view);

}  // namespace weft::frex
