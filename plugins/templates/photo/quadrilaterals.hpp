// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "sheet_view.hpp"
#include "straight_lines.hpp"

namespace weft::photo {

/// Four lines and where they meet.
struct Quadrilateral {
  Corners corners_px;
  std::array<std::size_t, 4> lines{};  ///< indices; line k runs from corner k to the next
  double merit = 0.0;                  ///< [] px^2, area times the share of the sides with edges
};

/// True if a place is in an image whose last pixel is `whole_px`, or at most `beside_px` beside it.
bool is_within(const Eigen::Vector2d& place_px, const Eigen::Vector2d& whole_px, double beside_px);

/// The four borders of an image, as lines that are edges all along.
std::array<StraightLine, 4> borders_of(const Eigen::Vector2d& whole_px);

/// How much of a quadrilateral must be seen as edges.
struct Needed {
  double share_of_side = 0.5;  ///< [] of each side
  int corners = 3;             ///< with edges on both sides of them
  double beside_px = 1.0;      ///< how far corners may be outside of the image
  /// If given, just one of its sides is this line or one behind it, and its corners are seen.
  std::optional<std::size_t> one_side_from{};
};

/// Convex quadrilaterals with sides on the lines and corners in the image, clockwise. They have the
/// needed edges, can be rectangles seen by a camera, and are not smaller than 8 % of the image. At
/// most `most`, the best first.
std::vector<Quadrilateral> find_quadrilaterals(const std::vector<StraightLine>& lines,
                                               const Eigen::Vector2d& whole_px, std::size_t most,
                                               const Needed& needed = {});

}  // namespace weft::photo
