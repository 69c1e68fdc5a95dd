// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/rng.hpp>
#include <weft/data/camera.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/types.hpp>

namespace weft::frex {

/// Ranges of shapes and poses.
struct SheetRanges {
  double nearest = 1.05;   ///< [] least distance; at 1 the width of the surface fills the image
  double farthest = 2.6;   ///< [] largest distance, in the same unit
  double tilt_rad = 0.5;   ///< [] rad, standard deviation of the tilt, at most 60 degrees
  double roll_rad = 0.45;  ///< [] rad, standard deviation of the turn about the optical axis
  double bend = 1.0;       ///< [] size of the deformation, 1 is usual
};

/// Draws isometric shapes and poses of a flat surface: generalised cylinders and generalised cones,
/// whose curvature is a constant and up to two waves. The lengths are exact. Each draw depends on
/// the generator alone.
class RandomSheet {
 public:
  /// `flat_m` [V,2] m are the vertices in the template frame.
  RandomSheet(const SheetRanges& ranges, const Points2& flat_m, const Camera& camera);

  /// The vertices [V,3] m, camera frame. At least three quarters of them lie in the image, or the
  /// surface is in its middle.
  Points3 draw(Rng& rng) const;

 private:
  Points3 shape(Rng& rng) const;
  Points3 cylinder(Rng& rng) const;
  Points3 cone(Rng& rng) const;
  bool is_inside(const Points3& vertices_m) const;

  SheetRanges ranges_;
  Camera camera_;
  Pinhole pinhole_;
  Points2 centred_m_;  ///< [V,2] from the middle of the surface
  double width_m_, diagonal_m_;
};

}  // namespace weft::frex
