// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>

#include "sheet_view.hpp"

namespace weft::photo {

/// L*a*b* of an image at a place in px.
using Colours = std::function<Eigen::Vector3d(const Eigen::Vector2d& place_px)>;

/// Bilinear colour of an image [H,W,3] u8; beyond its border, that of the border.
Eigen::Vector3d colour_at(const cv::Mat& picture, const Eigen::Vector2d& place_px);

/// How far from a side edges are searched, and how near the fitted line they must be to count.
struct Reach {
  double search_px = 3.0;
  double on_line_px = 1.0;
};

/// In which share of the places along a side there is an edge on it.
struct SideEvidence {
  double whole = 0.0;
  double at_start = 0.0, at_end = 0.0;  ///< next to the two corners, inside
  double before = 0.0, beyond = 0.0;    ///< next to the two corners, outside: the line goes on
  /// The same share, of edges in runs of a twelfth of the side or more, with hardly a gap. This is
  /// how a partly hidden side looks, unlike edges that lie on a line by chance.
  double in_runs = 0.0;
};

struct FittedSides {
  Corners corners_px;
  std::array<SideEvidence, 4> sides;  ///< from each corner to the next
};

/// Moves the sides of a quadrilateral to the edges nearby. In places along each side it finds the
/// steepest change of colour across the side within `reach.search_px`, to a fraction of a pixel. It
/// fits a line to these by Geman and McClure's robust error. A side without edges stays. Corners
/// are the intersections of fitted sides, and are undefined where those are parallel. The side
/// `fixed`, which is the border of the image, stays and has no evidence.
FittedSides fit_sides(const Colours& colours, const Corners& corners_px, const Reach& reach,
                      std::optional<std::size_t> fixed = std::nullopt);

}  // namespace weft::photo
