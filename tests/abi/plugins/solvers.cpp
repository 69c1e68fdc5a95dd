// SPDX-License-Identifier: Apache-2.0
#include <weft/sdk/solver.hpp>

namespace {

/// The template at a fixed depth.
struct Small final : weft::Solver {
  double depth_m = 2.0;

  explicit Small(weft::Params& p) { p.read("depth_m", depth_m, "m", {0.5, 8}, "of all vertices"); }

  weft::Result<weft::Shape> solve(const weft::SolverInput& in) override {
    const std::int64_t vertices = in.templ.vertices_m.rows();
    weft::Shape shape;
    shape.vertices_m = weft::Array<double>({vertices, 3});
    shape.source = weft::Array<std::uint8_t>({vertices}, 1);
    for (std::int64_t i = 0; i < vertices; ++i) {
      shape.vertices_m(i, 0) = in.templ.vertices_m(i, 0);
      shape.vertices_m(i, 1) = in.templ.vertices_m(i, 1);
      shape.vertices_m(i, 2) = depth_m;
    }
    shape.state = static_cast<std::int32_t>(weft::ShapeState::weak);
    shape.confidence = 0.25;
    return weft::degenerate(shape, "the depth is fixed");
  }
};

}  // namespace

WEFT_PLUGIN(Small, "solvers/kept.small", "1.0.0", "The template at a fixed depth.")
