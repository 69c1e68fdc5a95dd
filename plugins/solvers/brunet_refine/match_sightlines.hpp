// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/sightlines.hpp>

namespace weft::brunet_refine {

/// A sightline for each kept match on the mesh, for a start that takes no matches. `face_count` is
/// that of the template.
Sightlines match_sightlines(const Correspondences& matches, const Camera& camera,
                            std::int64_t face_count);

}  // namespace weft::brunet_refine
