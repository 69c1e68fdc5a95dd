// SPDX-License-Identifier: Apache-2.0
#include "surface_shape.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/statistics.hpp>

#include "common/shape_signs.hpp"

namespace weft::solvers {

Result<Shape> surface_shape(const SolverInput& in, const WarpGrid& grid,
                            const Points3View& vertices_m) {
  if (!(vertices_m.allFinite() && vertices_m.col(2).minCoeff() > 0.0)) {
    return no_result("the surface reaches behind the camera");
  }
  Shape shape;
  shape.vertices_m = make_array<double>(vertices_m);
  shape.source = Array<std::uint8_t>({vertices_m.rows()});
  const auto flat_px = in.templ.flat_px.matrix<2>();
  for (Eigen::Index v = 0; v < flat_px.rows(); ++v) {
    shape.source(v) = grid.near_match(flat_px.row(v)) ? 1 : 0;
  }
  const ShapeSigns signs = shape_signs(in, grid.edges(), vertices_m);
  const double strain = signs.strain;
  const ShapeEvidence& evidence = signs.evidence;
  // Half where lengths are off by 3 % in the mean; not calibrated.
  shape.confidence = std::min(1.0, evidence.agreeing / 30.0) *
                     logistic(-2.0 * std::log((strain + 1e-3) / 0.03)) *
                     confidence_of_filters(in.correspondences);
  signs.tell(shape.diag);
  return shape;
}

}  // namespace weft::solvers
