// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <weft/geometry/types.hpp>

#include "energy.hpp"
#include "mesh/mesh_model.hpp"

namespace weft::gauss_newton {

/// The mesh at rest, [V,3] m in the camera frame, facing the camera where it is seen. An affine map
/// from the plane of the rest mesh to the image gives size, rotation in the image and place. It
/// minimises the sum of distances over the observations. Nothing where the observations lie on a
/// line or show the back.
std::optional<Points3> frontal_guess(const FrameData& frame, const MeshModel& mesh);

}  // namespace weft::gauss_newton
