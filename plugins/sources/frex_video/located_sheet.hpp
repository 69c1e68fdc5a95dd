// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "sheet_surface.hpp"
#include "sheet_warp.hpp"

namespace weft::frex_video {

inline constexpr double kMetre = 0.001;  ///< in a millimetre

/// The place of the surface in one frame.
struct LocatedSheet {
  SheetWarp warp;
  Points3 rough_centres_m;  ///< [M,3] m, camera frame, of the markers, each by itself; or NaN
  SheetSurface surface;
  cv::Mat1b known;  ///< [height_mm + 1, width_mm + 1] 1 within 10 mm of the markers' convex hull

  /// True if the surface is measured at a point, and not only continued.
  bool is_known(const Eigen::Vector2d& point_mm) const;
};

struct LocateOptions {
  std::size_t min_markers = 30;
  double max_marker_error_px = 3.0;  ///< px, of a marker from the warp of the others
};

/// no_result where too few markers are found and agree, and where no surface fits them.
Result<LocatedSheet> locate_sheet(const MarkerFinder& finder, const cv::Mat& grey,
                                  const Pinhole& camera, const LocateOptions& options);

}  // namespace weft::frex_video
