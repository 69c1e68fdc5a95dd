// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <string>
#include <utility>
#include <weft/data/matrix.hpp>
#include <weft/sdk/solver.hpp>

#include "common/smooth_spline.hpp"
#include "common/surface_shape.hpp"
#include "common/warp_grid.hpp"
#include "conformal_depth.hpp"

namespace weft::bartoli_conformal {
namespace {

constexpr std::size_t kFewestPoints = 50;
// Fitted to simulated surfaces: docs/evidence/0023-confidence-of-solvers.md.
constexpr solvers::ConfidenceWeights kConfidence{.bias = -28.556,
                                                 .strain = -1.686,
                                                 .strain_p95 = -1.435,
                                                 .size = 2.357,
                                                 .agreeing = 0.534,
                                                 .share = 0.681};

/// The closed-form conformal solution: a surface whose local scale is free.
class BartoliConformal final : public Solver {
 public:
  static constexpr About kAbout{
      .reference =
          "paper: Bartoli, Gerard, Chadebecq, Collins, Pizarro, Shape-from-Template, "
          "TPAMI 37(10) (2015)",
      .needs = "correspondences",
      .reads = ""};

  explicit BartoliConformal(Params& p) {
    grid_.declare(p);
    p.read("integration_smoothing", integration_smoothing_, "", {1e-12, 1e6},
           "bending weight of the integrated distance, relative to squared slopes");
    p.read("control", control_, "", {4, 40},
           "number of control points of the surface along u and along v");
    p.read("smoothing", smoothing_, "", {1e-6, 1e6},
           "weight of the surface's bending energy, in areas of a knot cell");
  }

  Result<Shape> solve(const SolverInput& in) override {
    const auto warp = grid_.read(in);
    if (!warp) return warp.error();
    const auto reading = solvers::isometric_reading(warp->places);
    if (reading.points.size() < kFewestPoints) {
      return no_result("the warp is known at " + std::to_string(reading.points.size()) +
                       " places of at least " + std::to_string(kFewestPoints));
    }
    const SplineDomain domain = grid_.domain(control_);
    equations_.set_domain(domain);
    surface_.set_domain(domain);
    const auto found = conformal_surface(equations_, reading, integration_smoothing_);
    if (!found) return found.error();
    if (auto fitted = surface_.fit(reading.places_px, found->points_m, smoothing_); !fitted) {
      return fitted.error();
    }
    auto shape =
        solvers::surface_shape(in, grid_, surface_.at(in.templ.flat_px.matrix<2>()), kConfidence);
    if (!shape) return shape;
    // Half where the other surface is as likely.
    const double chosen = found->scale_spread, other = found->other_scale_spread;
    shape->confidence *= other > 0.0 ? other * other / (chosen * chosen + other * other) : 0.5;
    shape->diag.set("points", static_cast<double>(reading.points.size()));
    shape->diag.set("folded_points", static_cast<double>(reading.folded));
    shape->diag.set("scale_spread", chosen);
    shape->diag.set("other_scale_spread", other);
    if (warp->degenerate_reason.empty()) return shape;
    return degenerate(*std::move(shape), warp->degenerate_reason);
  }

  bool joins_seams() const override { return false; }  // works in the plane of the texture

 private:
  solvers::WarpGrid grid_;
  double integration_smoothing_ = 0.01;
  int control_ = 12;
  double smoothing_ = 0.1;
  solvers::SplineEquations equations_;
  solvers::SmoothSpline surface_;
};

}  // namespace
}  // namespace weft::bartoli_conformal

using weft::bartoli_conformal::BartoliConformal;
WEFT_PLUGIN(BartoliConformal, "solvers/bartoli_conformal", "1.1.0",
            "Computes a conformal shape in closed form from a warp and its first derivatives.")
