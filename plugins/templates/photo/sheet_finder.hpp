// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "photograph.hpp"
#include "sheet_view.hpp"

namespace weft::photo {

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
/// Fails, saying what to do, where there is none.
Result<Corners> find_sheet(const Photograph& photo);

/// The same corners from the one that is the top left where the sheet is read as upright as the
/// photograph: its upper side runs as far to the right as it can. They are clockwise before.
Corners upright(const Corners& corners_px);

}  // namespace weft::photo
