// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>
#include <weft/core/result.hpp>

#include "common/smooth_spline.hpp"
#include "common/warp_grid.hpp"
#include "shape_from_normals.hpp"
#include "stable_depth.hpp"

namespace weft::chhatkuli_stable {

/// The two normals [3], unit and towards the camera, that the warp leaves: those of the tangents
/// n grad(theta)^T + theta J_n with both signs of the gradient.
std::pair<Eigen::Vector3d, Eigen::Vector3d> candidate_normals(const solvers::WarpPlace& place,
                                                              const solvers::IsometricPoint& point);

/// The surface of Chhatkuli, Pizarro, Bartoli, Collins, TPAMI 39(5), 2017. From the two normals at
/// each place it takes the one nearer to the normals of a spline through the direct points. It fits
/// a depth over the image to these normals, with the median of the direct depths.
class DepthFromNormals {
 public:
  /// With `control` control points along both sides of the square around what is seen.
  Result<StableDepth> find(const solvers::IsometricReading& reading, int control,
                           const Smoothing& smoothing);

 private:
  Result<Points3> reference_normals(const solvers::IsometricReading& reading,
                                    const Points2View& places, const SplineDomain& domain,
                                    double smoothing);

  solvers::SmoothSpline reference_;
  ShapeFromNormals shape_;
};

}  // namespace weft::chhatkuli_stable
