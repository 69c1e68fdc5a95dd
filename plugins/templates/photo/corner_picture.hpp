// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

#include "photograph.hpp"
#include "sheet_view.hpp"

namespace weft::photo {

/// The overlays on a photograph.
struct Findings {
  Corners corners_px;               ///< ideal px
  Eigen::Matrix3d ideal_from_unit;  ///< from the unit square of the surface
  int columns = 0, rows = 0;        ///< vertices of the mesh
  std::string size;                 ///< "297.0 x 210.1 mm"
};

/// Writes a PNG of the photograph, at most 1600 px large, with the mesh and the surface's sides and
/// corners. The corners are numbered from the top left on and have their places in px.
Result<void> write_corner_picture(const Photograph& photo, const Findings& findings,
                                  const std::string& path);

}  // namespace weft::photo
