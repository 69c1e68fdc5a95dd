// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/geometry/types.hpp>

namespace weft::gms {

/// The possible neighbours of the cells of both images.
struct Layout {
  int cells = 20;                             ///< cells of the template, along each side
  int image_cells = 20;                       ///< cells of the image, along each side
  int turn = 0;                               ///< eighths of a full turn from template to image
  bool shifted_u = false, shifted_v = false;  ///< the template's grid, by half a cell
};

/// How much the cells around support each match. Let a be the match's cell in the template, and b
/// the cell of the image to which most matches of a go. S is the sum over the 3 x 3 cells around a
/// of the matches that go from a cell to its counterpart around b. The support is S over the root
/// of the mean number of matches in the cells around a (Bian et al. 2017, Equations 13 and 14). It
/// is 0 for a match that goes from a elsewhere, and where a has no 3 x 3 cells around it. Places
/// are [n,2] in parts of the images' widths and heights; counterparts are turned by `turn`.
std::vector<double> support_of(const Points2& in_template, const Points2& in_image,
                               const Layout& layout);

}  // namespace weft::gms
