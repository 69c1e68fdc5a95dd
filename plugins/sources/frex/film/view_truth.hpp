// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/ground_truth.hpp>
#include <weft/geometry/types.hpp>

#include "common/scene/sheet_renderer.hpp"

namespace weft::frex {

/// The parts of the truth that all frames share.
struct TruthFrame {
  Array<double> flat_m;        ///< [T,2] m, template frame, of the truth's points
  Array<std::int32_t> faces;   ///< [G,3] over them
  Eigen::RowVector2d pitch_m;  ///< [2] m, size of a texel
  bool has_maps = true;        ///< depth and template point of each pixel
};

/// The truth of a rendered view of the vertices [V,3] m, camera frame. The first T of them are the
/// truth's points.
GroundTruth truth_of(const TruthFrame& frame, const Points3& vertices_m, const scene::View& view);

}  // namespace weft::frex
