// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>
#include <weft/geometry/types.hpp>

#include "rest_sheet.hpp"

namespace weft::frex {

/// What a sheet that is curved about one direction at rest, as a part of a cylinder is, looks like
/// across that direction. Bent about it and about no other, such a sheet keeps its lengths.
class CrossSection {
 public:
  /// The rest shape has to be straight along one direction of its texture and to unroll to its
  /// template points: nothing for flat sheets and for those that are curved both ways.
  static std::optional<CrossSection> of(const RestSheet& sheet);

  /// Direction of the template across which the sheet is curved.
  double ruling_rad() const { return ruling_rad_; }

  /// The points [V,2] m of the unrolled sheet, measured from its middle, on the sheet [V,3] m with
  /// a curvature added at s m from the middle: the curve is the integral of R(a(s)) c'(s), c that
  /// at rest and a the integral of the curvature.
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
