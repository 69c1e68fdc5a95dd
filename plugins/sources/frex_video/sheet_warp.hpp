// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/core/result.hpp>
#include <weft/geometry/thin_plate_spline.hpp>

#include "marker_finder.hpp"

namespace weft::frex_video {

/// The map from the flat paper to the image, and the markers that agree with it.
struct SheetWarp {
  ThinPlateSpline image_px;         ///< from a point of the paper in mm
  std::vector<SeenMarker> markers;  ///< that it passes through
  double leave_one_out_px = 0.0;    ///< median distance of a marker from the warp of the others
};

/// Passes a thin-plate spline through the markers' centres. While a marker is farther than
/// `max_distance_px` from the spline of the others, the farthest one is dropped and the spline
/// fitted again. Fails with no_result where fewer than `least` markers are left.
Result<SheetWarp> fit_warp(const MarkerSheet& sheet, std::vector<SeenMarker> markers,
                           std::size_t least, double max_distance_px);

}  // namespace weft::frex_video
