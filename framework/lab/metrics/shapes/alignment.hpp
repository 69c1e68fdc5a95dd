// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>
#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

namespace weft::lab {

/// Transform that is removed from an error before it is measured, frame by frame.
enum class Alignment {
  none,   ///< nothing: the error in the camera frame
  scale,  ///< one factor s about the camera's centre, least sum |s X - X_truth|^2
  rigid,  ///< one rotation and translation, least sum of squares: the error of form alone
};

/// "none", "scale" or "rigid"; every table and file with errors names it.
const char* to_string(Alignment alignment);
std::optional<Alignment> alignment_of(std::string_view name);

/// The estimated points [N,3] moved onto the true ones [N,3], both in m, camera frame. Returns
/// no_result if the points do not determine the transform (too few, on a line, in the camera's
/// centre).
Result<Points3> align_estimate(const Points3View& estimated_m, const Points3View& truth_m,
                               Alignment alignment);

}  // namespace weft::lab
