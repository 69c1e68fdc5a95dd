// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/bspline_basis.hpp>

#include "spline_costs.hpp"

namespace weft::brunet_refine {

/// The derivatives of a spline surface along two orthonormal directions of the template at rest.
struct MetricPlace {
  SiteWeights first, second;  ///< [16] 1/m, of the control points around
  Eigen::Index corner = 0;    ///< [] control_index() of the first of these
};

/// The rectangle around the template in its texture, with `control` points along u and along v.
SplineDomain domain_around(const Template& templ, int control);

/// `per_cell` places along each side of each knot cell, those that lie on the mesh. With the rest
/// metric K = L L^T [2,2] m^2/px^2 of the face there, the directions are the columns of L^-T. Their
/// images are J = (phi_u, phi_v) L^-T, and the surface is isometric where J^T J = I. The template
/// must pass validate_flat_mesh.
Result<std::vector<MetricPlace>> metric_places(const Template& templ, const SplineDomain& domain,
                                               int per_cell);

}  // namespace weft::brunet_refine
