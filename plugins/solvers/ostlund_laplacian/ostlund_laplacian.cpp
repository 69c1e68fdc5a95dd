// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <weft/sdk/solver.hpp>

#include "common/laplacian/inextensible_fit.hpp"
#include "common/laplacian/laplacian_front.hpp"
#include "common/laplacian/laplacian_shape.hpp"
#include "common/laplacian/length_fit.hpp"

namespace weft::ostlund_laplacian {
namespace {

// Fitted to simulated surfaces: docs/evidence/0023-confidence-of-solvers.md.
constexpr solvers::ConfidenceWeights kConfidence{.bias = -32.454,
                                                 .strain = -1.020,
                                                 .strain_p95 = -0.090,
                                                 .residual = -0.609,
                                                 .size = 3.596,
                                                 .agreeing = 1.322,
                                                 .share = 9.377};

/// How the lengths of the edges are kept.
enum class Method { slacks, convex };

/// A mesh moved by few control vertices: linear with outlier rejection, then without stretch.
class OstlundLaplacian final : public Solver {
 public:
  static constexpr About kAbout{.reference =
                                    "paper: Ostlund, Varol, Ngo, Fua, Laplacian Meshes for "
                                    "Monocular 3D Shape Recovery, ECCV (2012)",
                                .needs = "correspondences",
                                .reads = ""};

  explicit OstlundLaplacian(Params& p) {
    const Preset preset = declare_preset(p);
    if (preset == Preset::weft) method_ = Method::convex;
    front_.declare(p, preset);
    p.choice("method", method_, {{"slacks", Method::slacks}, {"convex", Method::convex}},
             "constrained fit; slacks: the published steps; convex: a convex program with a pull "
             "away from the camera");
    double stiffness = method_ == Method::slacks ? slacks_.stiffness : convex_.stiffness;
    p.read("fit_stiffness", stiffness, "", {0.0, 1e3},
           "weight of the regularisation under the constraints");
    slacks_.stiffness = convex_.stiffness = stiffness;
    p.read("tension_m", slacks_.tension_m, "m", {1e-6, 10.0},
           "tension that pulls each edge to its length; for slacks");
    p.read("steps", slacks_.max_iterations, "", {1, 10000}, "number of Newton steps; for slacks");
    p.read("pull_px", convex_.pull_px, "px", {1e-4, 10.0},
           "pull away from the camera, as the displacement of a match without other constraints; "
           "for convex");
    p.read("tolerance_m", convex_.tolerance_m, "m", {1e-12, 1.0},
           "root mean square excess of the edge lengths at which the iteration stops; for convex");
    p.read("max_iterations", convex_.max_iterations, "", {1, 1000000},
           "maximum number of iterations; for convex");
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (auto read = front_.read(in); !read) return read.error();
    return method_ == Method::slacks ? solve_by_slacks(in) : solve_convex(in);
  }

 private:
  Result<Shape> solve_by_slacks(const SolverInput& in) const {
    const solvers::LengthFitter fitter(front_.mesh(), front_.inliers(), slacks_, std::nullopt);
    const solvers::LengthFit fit = fitter.fit(front_.inliers().shape.controls_m);
    if (!std::isfinite(fit.energy_m2)) return no_result("the constrained steps diverged");
    auto shape = shape_of(in, fit.controls_m);
    if (shape) shape->diag.set("iterations", fit.iterations);
    return shape;
  }

  Result<Shape> solve_convex(const SolverInput& in) const {
    const solvers::InextensibleFit fit =
        solvers::inextensible_fit(front_.mesh(), front_.matches(), front_.inliers(), convex_);
    auto shape = shape_of(in, fit.controls_m);
    if (!shape) return shape;
    shape->diag.set("iterations", fit.iterations);
    shape->diag.set("converged", fit.converged ? 1.0 : 0.0);
    if (fit.converged) return shape;
    shape->state = static_cast<std::int32_t>(ShapeState::weak);
    return degenerate(*std::move(shape), "not converged in " + std::to_string(fit.iterations) +
                                             " iterations: raise max_iterations");
  }

  Result<Shape> shape_of(const SolverInput& in, const Eigen::MatrixX3d& controls_m) const {
    return solvers::shape_of_controls(in, front_.mesh(), front_.matches(), front_.inliers(),
                                      controls_m, kConfidence);
  }

  solvers::LaplacianFront front_;
  Method method_ = Method::slacks;
  solvers::LengthFitOptions slacks_;
  solvers::InextensibleFitOptions convex_;
};

}  // namespace
}  // namespace weft::ostlund_laplacian

using weft::ostlund_laplacian::OstlundLaplacian;
WEFT_PLUGIN(OstlundLaplacian, "solvers/ostlund_laplacian", "2.0.0",
            "Fits a Laplacian mesh with few control vertices, with its own outlier rejection.")
