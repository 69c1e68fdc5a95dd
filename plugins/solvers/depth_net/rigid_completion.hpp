// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

#include "planar_frame.hpp"
#include "rest_sheet.hpp"

namespace weft::depth_net {

/// Where the completion begins, and what it keeps.
struct Draft {
  Points3 vertices_m;         ///< [V,3] camera frame
  std::vector<Frame> frames;  ///< [V]
  /// [V] 1/m^2, number of measurements of a vertex over their variance; 0 where there are none.
  Eigen::VectorXd certainty;
};

/// The surface that is as rigid as possible (Sorkine and Alexa 2007). It minimizes
///
///     sum_v c_v |X_v - Y_v|^2
///       + 1 / rho^2 sum_v sum_w s_vw / 2 |X_v - X_w - Q_v (x_v - x_w)|^2
///
/// over the vertices X and a frame Q_v of each of them. Y is the draft, c its certainty and rho
/// `rigidity_m`. The index w runs over the neighbours of v, and s is the stiffness of the edge. On
/// fine meshes the second term is the integral of |grad X - Q|^2 over the template.
///
/// Each iteration solves for all X, then for each Q. Vertices without measurement keep a negligible
/// tie to the draft, so that the solution is unique.
Result<Points3> complete_rigidly(const RestSheet& sheet, const Draft& draft, double rigidity_m,
                                 int iterations);

}  // namespace weft::depth_net
