// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <utility>
#include <weft/sdk/solver.hpp>

#include "common/laplacian/inextensible_fit.hpp"
#include "common/laplacian/laplacian_front.hpp"
#include "common/laplacian/laplacian_shape.hpp"

namespace weft::ostlund_laplacian {
namespace {

// Fitted to simulated sheets: docs/evidence/0023-confidence-of-solvers.md.
constexpr solvers::ConfidenceWeights kConfidence{.bias = -32.454,
                                                 .strain = -1.020,
                                                 .strain_p95 = -0.090,
                                                 .residual = -0.609,
                                                 .size = 3.596,
                                                 .agreeing = 1.322,
                                                 .share = 9.377};

/// A mesh moved by few control vertices: linear with outlier rejection, then without stretch.
class OstlundLaplacian final : public Solver {
 public:
  static constexpr About kAbout{
      .reference =
          "Ostlund, Varol, Ngo, Fua, Laplacian Meshes for Monocular 3D Shape Recovery, ECCV (2012)",
      .needs = "correspondences",
      .reads = ""};

  explicit OstlundLaplacian(Params& p) {
    front_.declare(p);
    p.read("fit_stiffness", fit_.stiffness, "", {0.0, 1e3},
           "weight of the regularisation where lengths hold the sheet");
    p.read("pull_px", fit_.pull_px, "px", {1e-4, 10.0},
           "pull away from the camera: how far it moves a match that nothing else holds");
    p.read("tolerance_m", fit_.tolerance_m, "m", {1e-12, 1.0},
           "rms excess of the edges at which the iteration stops");
    p.read("max_iterations", fit_.max_iterations, "", {1, 1000000}, "of the convex solver");
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (auto read = front_.read(in); !read) return read.error();
    const solvers::InextensibleFit fit =
        solvers::inextensible_fit(front_.mesh(), front_.matches(), front_.inliers(), fit_);
    auto shape = solvers::shape_of_controls(in, front_.mesh(), front_.matches(), front_.inliers(),
                                            fit.controls_m, kConfidence);
    if (!shape) return shape;
    shape->diag.set("iterations", fit.iterations);
    shape->diag.set("converged", fit.converged ? 1.0 : 0.0);
    if (fit.converged) return shape;
    shape->state = static_cast<std::int32_t>(ShapeState::weak);
    return degenerate(*std::move(shape), "not converged in " + std::to_string(fit.iterations) +
                                             " iterations: raise max_iterations");
  }

 private:
  solvers::LaplacianFront front_;
  solvers::InextensibleFitOptions fit_;
};

}  // namespace
}  // namespace weft::ostlund_laplacian

using weft::ostlund_laplacian::OstlundLaplacian;
WEFT_PLUGIN(OstlundLaplacian, "solvers/ostlund_laplacian", "1.1.0",
            "Shape of a Laplacian mesh with few controls from matches; it finds its own outliers.")
