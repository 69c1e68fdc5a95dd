// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/data/camera.hpp>
#include <weft/data/template.hpp>
#include <weft/data/warp.hpp>
#include <weft/geometry/mesh_adjacency.hpp>

#include "sight.hpp"

namespace weft::self_occlusion {

/// The visibility by a warp without any shape (after Pizarro and Bartoli, Feature-based deformable
/// surface detection with self-occlusion reasoning, IJCV 97, 2012). Let J be the affine map of a
/// face from the texture to the image. The face is folded where det J does not have the sign of
/// most faces. It is contracted where its smaller singular value is below 0.15 of the median. A
/// vertex is hidden if all faces around it are, and outside if its place is not in the image. A
/// face whose vertices are not evaluated gives no evidence.
Sight look_at_warp(const Template& templ, const WarpSamples& warped, const IndexLists& around,
                   const Camera& camera);

}  // namespace weft::self_occlusion
