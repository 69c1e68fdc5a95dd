// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>
#include <weft/geometry/bspline_basis.hpp>
#include <weft/geometry/types.hpp>

namespace weft::pizarro {

/// A grid of square cells over the texture, and the cells that the surface hides from the camera.
struct HiddenMap {
  int columns = 0, rows = 0;
  double cell_px = 1.0;
  std::vector<std::uint8_t> hidden;  ///< [rows * columns] 1 where hidden
  double least_det =
      0.0;  ///< smallest determinant of the warp's Jacobian, over the median at matches

  bool at(double u_px, double v_px) const;
  double share() const;
};

/// The cells that a warp fitted to matches [n,2] px hides, of a texture of this size. The warp
/// turns the surface over there, or contracts it to less than 0.2 of the median at the matches.
///
/// The warp is a bicubic B-spline (Rueckert 1999) that does not fold. Where its Jacobian's
/// determinant would change sign it is contracted instead (after Pizarro and Bartoli 2012, Section
/// 4),
///     min sum |W(p) - q|^2 + lambda E_bend + mu sum_s max(0, m - det J_s / median det)^2.
/// Nothing where the matches do not determine it.
std::optional<HiddenMap> hidden_by_itself(const Points2& in_template, const Points2& in_image,
                                          const Eigen::RowVector2d& texture_px);

}  // namespace weft::pizarro
