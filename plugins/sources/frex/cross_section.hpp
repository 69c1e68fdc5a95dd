// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>
#include <weft/geometry/types.hpp>

#include "rest_sheet.hpp"

namespace weft::frex {

/// The profile of a surface that is curved about one direction at rest, such as a part of a
/// cylinder, across that direction. Such a surface keeps its lengths if it is bent only about that
/// direction.
class CrossSection {
 public:
  /// The rest shape has to be straight along one direction of its texture and to unroll to its
  /// template points. Returns nothing for flat surfaces, for those that are curved both ways, and
  /// for those with seams.
  static std::optional<CrossSection> of(const RestSheet& sheet);

  /// Direction of the template across which the surface is curved.
  double ruling_rad() const { return ruling_rad_; }

  /// The points [V,2] m of the unrolled surface, measured from its middle, on the surface [V,3] m.
  /// A curvature is added at s m from the middle. The curve is the integral of R(a(s)) c'(s), with
  /// c the curve at rest and a the integral of the curvature.
  Points3 rolled(const Points2& unrolled_m,
                 const std::function<double(double s_m)>& curvature_per_m) const;

 private:
  /// The piece of the curve at a place, the first or the last beyond its ends.
  Eigen::Index piece_at(double place_m) const;

  double ruling_rad_ = 0.0;
  std::vector<double> along_m_;           ///< [K] m from the middle, ascending
  std::vector<Eigen::Vector2d> curve_m_;  ///< [K] m, c: across, and away from the camera
};

}  // namespace weft::frex
