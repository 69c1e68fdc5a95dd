// SPDX-License-Identifier: Apache-2.0
#include "surface_shape.hpp"

#include <weft/data/matrix.hpp>

namespace weft::solvers {

Result<Shape> surface_shape(const SolverInput& in, const WarpGrid& grid,
                            const Points3View& vertices_m, const ConfidenceWeights& weights) {
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
  shape.confidence = confidence(signs, weights, in.correspondences);
  signs.tell(shape.diag);
  return shape;
}

}  // namespace weft::solvers
