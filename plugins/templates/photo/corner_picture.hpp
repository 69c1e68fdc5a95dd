// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "photograph.hpp"
#include "sheet_view.hpp"

namespace weft::photo {

/// What is drawn over a photograph.
struct Findings {
  Corners corners_px;               ///< ideal px
  Eigen::Matrix3d ideal_from_unit;  ///< the sheet's unit square
  int columns = 0, rows = 0;        ///< vertices of the mesh
  std::string size;                 ///< "297.0 x 210.1 mm"
};

/// The photograph, at most 1600 px large, with the sheet's sides, corners, which are numbered from
/// the top left on and have their places in px, and the mesh; BGR.
cv::Mat draw_corners(const Photograph& photo, const Findings& findings);

}  // namespace weft::photo
