// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>
#include <weft/geometry/bspline_basis.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/types.hpp>

namespace weft::frex_video {

/// The measurements of a sheet of paper in one image; the paper's own coordinates are in m.
struct SheetSightings {
  Points2 corners_m;        ///< [N,2] m, points of the paper that the image shows
  Points2 corners_px;       ///< [N,2] px, where
  Points2 centres_m;        ///< [M,2] m, points of the paper with a roughly known place
  Points3 rough_centres_m;  ///< [M,3] m, camera frame; NaN where it is not known
};

/// A sheet of paper in space, X(x,y) in the camera frame: a bicubic B-spline that bends but hardly
/// stretches. It minimises over its control points
///     sum |pi(X(p_k)) - q_k|^2 / s_px^2 (Huber) + sum |first fundamental form - I|^2 / s_strain^2
///   + sum |second derivatives|^2 / s_bend^2 + sum (Z(p_i) - Z_i)^2 / (s_depth Z_i)^2
/// by Levenberg-Marquardt from the smooth surface near the rough points. Length on paper makes
/// depth much better known than the size of single markers does (isometric Shape-from-Template:
/// Bartoli et al., PAMI 2015).
class SheetSurface {
 public:
  /// no_result where the surface does not meet the sightings.
  static Result<SheetSurface> fit(const Eigen::Vector2d& size_m, const SheetSightings& sightings,
                                  const Pinhole& camera);

  /// The point of the paper at (x,y) m, in the camera frame.
  Eigen::Vector3d at(const Eigen::Vector2d& point_m) const;
  /// Unit normal of the printed side, which looks at the camera.
  Eigen::Vector3d normal(const Eigen::Vector2d& point_m) const;

  double rms_px() const { return rms_px_; }          ///< reprojection error of the corners
  double rms_strain() const { return rms_strain_; }  ///< [] of lengths along x and y

 private:
  SplineDomain domain_;
  Points3 control_m_;
  double rms_px_ = 0.0;
  double rms_strain_ = 0.0;
};

}  // namespace weft::frex_video
