// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <weft/data/image.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/types.hpp>

#include "gauss_newton/mesh/mesh_model.hpp"

namespace weft::gauss_newton {

/// The mesh at rest, [V,3] m in the camera frame, frontal, where area, centroid and main axis of
/// its projection are those of the foreground. A mask does not distinguish two poses that differ by
/// half a turn: this is the one with less rotation. Nothing for an empty mask.
std::optional<Points3> outline_start(const ObjectMask& mask, const Pinhole& camera,
                                     const MeshModel& mesh);

}  // namespace weft::gauss_newton
