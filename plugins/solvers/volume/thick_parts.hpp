// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solid_model.hpp"

namespace weft::volume {

/// Balls that touch the surface at two places or more and lie within it, and the mean deformation
/// in each. A body that bends stretches on one side and shrinks on the other. The mean over its
/// thickness is then nearly a rotation, and costs much less than that of a body that grows.
///
/// The ball that touches the surface at a point p with the inner normal n has the radius
/// min_q |q - p|^2 / (2 n . (q - p)) over the other surface points q (Ma, Bae and Choi, 3D medial
/// axis point approximation using nearest neighbors and the normal field, The Visual Computer 28,
/// 2012). The two places must lie on opposite sides, more than 120 degrees apart from the centre;
/// of balls that share most of their volume the largest stays. A mean is over the centroids of the
/// quarters of tetrahedra, weighted so that their mean place is the centre.
///
/// An even bend or twist is nearly a map of second degree in a ball 1.4 times as wide. The squared
/// distance of the nodes from such a map, in radii, is the unevenness of the part.
std::vector<ThickPart> thick_parts(const SolidModel& body);

}  // namespace weft::volume
