// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <string>
#include <utility>
#include <weft/data/matrix.hpp>
#include <weft/sdk/solver.hpp>

#include "common/smooth_spline.hpp"
#include "common/surface_shape.hpp"
#include "common/warp_grid.hpp"

namespace weft::bartoli_isometric {
namespace {

constexpr std::size_t kFewestPoints = 16;
// Fitted to simulated surfaces: docs/evidence/0023-confidence-of-solvers.md.
constexpr solvers::ConfidenceWeights kConfidence{.bias = -27.760,
                                                 .strain = -0.588,
                                                 .strain_p95 = -0.576,
                                                 .residual = -1.285,
                                                 .roughness = -3.896,
                                                 .size = 2.087,
                                                 .agreeing = 1.291,
                                                 .share = 1.058,
                                                 .coverage = 0.499};

/// The closed-form isometric solution: depth from a warp and its first derivatives.
class BartoliIsometric final : public Solver {
 public:
  static constexpr About kAbout{
      .reference =
          "paper: Bartoli, Gerard, Chadebecq, Collins, Pizarro, Shape-from-Template, "
          "TPAMI 37(10) (2015)",
      .needs = "correspondences",
      .reads = ""};

  explicit BartoliIsometric(Params& p) {
    grid_.declare(p);
    p.read("control", control_, "", {4, 40},
           "number of control points of the surface along u and along v");
    p.read("smoothing", smoothing_, "", {1e-6, 1e6},
           "weight of the surface's bending energy, in areas of a knot cell");
  }

  Result<Shape> solve(const SolverInput& in) override {
    const auto warp = grid_.read(in);
    if (!warp) return warp.error();
    const auto found = solvers::isometric_reading(warp->places);
    if (found.points.size() < kFewestPoints) {
      return no_result("the depth is known at " + std::to_string(found.points.size()) +
                       " places of at least " + std::to_string(kFewestPoints));
    }
    surface_.set_domain(grid_.domain(control_));
    if (auto fitted = surface_.fit(found.places_px, found.points_m, smoothing_); !fitted) {
      return fitted.error();
    }
    auto shape =
        solvers::surface_shape(in, grid_, surface_.at(in.templ.flat_px.matrix<2>()), kConfidence);
    if (!shape) return shape;
    shape->diag.set("points", static_cast<double>(found.points.size()));
    shape->diag.set("folded_points", static_cast<double>(found.folded));
    if (warp->degenerate_reason.empty()) return shape;
    return degenerate(*std::move(shape), warp->degenerate_reason);
  }

  bool joins_seams() const override { return false; }  // works in the plane of the texture

 private:
  solvers::WarpGrid grid_;
  int control_ = 12;
  double smoothing_ = 0.1;
  solvers::SmoothSpline surface_;
};

}  // namespace
}  // namespace weft::bartoli_isometric

using weft::bartoli_isometric::BartoliIsometric;
WEFT_PLUGIN(BartoliIsometric, "solvers/bartoli_isometric", "1.1.0",
            "Computes an isometric shape in closed form from a warp and its first derivatives.")
