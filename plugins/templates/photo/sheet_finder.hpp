// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "photograph.hpp"
#include "sheet_view.hpp"

namespace weft::photo {

/// The parts of a surface that may be hidden.
enum class Missing {
  little,    ///< a corner, and half of a side
  to_hands,  ///< two corners, and most of a side, if the rest of it is seen without gaps
  one_side   ///< the same, and one side is the border of the photograph
};

struct FoundSheet {
  Corners corners_px{};                    ///< ideal px
  std::optional<std::size_t> border_side;  ///< from this corner to the next it ends at the border
};

/// The corners, in ideal px, of the largest rectangle of a photograph whose sides are straight
/// edges:
/// 1. straight lines of the photograph without distortion, 1000 px large;
/// 2. quadrilaterals of four of them, whose sides run along edges for half of their lengths;
/// 3. the sides of the best 60 are fitted to the edges, and the one with the largest
///      area * (share of the sides that is an edge)
///    is taken, less 15 % if one corner has no edges next to it and 10 % for each end, beyond
///    three, at which a side goes on: a printed frame is smaller than its sheet, lines of a table
///    go on;
/// 4. its sides are fitted again in the photograph itself, to a fraction of a pixel.
/// Where more may be missing, the surface covers a quarter of the photograph. Its sides are edges
/// along 25 % of their length, in runs without gaps and within 2.5 px, because paper in a hand is
/// not straight. Two corners are enough, and corners may be 15 px outside of the 1000. A side on
/// the border of the photograph is taken only if two others meet it there within 10 degrees of a
/// right angle. All four must be a rectangle within 3 degrees. A surface that is cut off aslant
/// does not pass this test. Fails, with a suggestion, where there is none.
Result<FoundSheet> find_sheet(const Photograph& photo, Missing missing = Missing::little);

/// The same corners, rotated so that the first is the top left one when the photograph is upright.
/// The upper side then runs as far to the right as it can. The input must be clockwise.
Corners upright(const Corners& corners_px);

}  // namespace weft::photo
