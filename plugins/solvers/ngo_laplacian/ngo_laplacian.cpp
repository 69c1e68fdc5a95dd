// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/solver.hpp>

#include "common/laplacian/inextensible_fit.hpp"
#include "common/laplacian/laplacian_front.hpp"
#include "common/laplacian/laplacian_shape.hpp"
#include "common/laplacian/length_fit.hpp"

namespace weft::ngo_laplacian {
namespace {

using solvers::LengthFit;
using solvers::LengthFitOptions;
using solvers::LengthFitter;
using solvers::Lengths;

// Fitted to simulated surfaces: docs/evidence/0023-confidence-of-solvers.md.
constexpr solvers::ConfidenceWeights kConfidence{.bias = -9.751,
                                                 .strain = -1.731,
                                                 .strain_p95 = -0.556,
                                                 .agreeing = 0.407,
                                                 .share = 0.188,
                                                 .coverage = 3.605};

/// Where an iteration began; the numbers are those of diag.start.
enum class Start { previous = 0, convex = 1, linear = 2 };

/// A Laplacian mesh in real time: linear with outlier rejection, then under constraints on lengths.
class NgoLaplacian final : public Solver {
 public:
  static constexpr About kAbout{.reference =
                                    "paper: Ngo, Ostlund, Fua, Template-Based Monocular 3D Shape "
                                    "Recovery Using Laplacian Meshes, "
                                    "TPAMI 38(1) (2016)",
                                .needs = "correspondences",
                                .reads = "previous.shape"};

  explicit NgoLaplacian(Params& p) {
    const Preset preset = declare_preset(p);
    if (preset == Preset::weft) {
      options_ = {.stiffness = 0.2, .max_iterations = 20, .tolerance_m = 1e-5};
      start_ = Start::convex;
      try_previous_ = true;
    }
    front_.declare(p, preset);
    p.choice("lengths", options_.lengths,
             {{"at_most", Lengths::at_most}, {"equal", Lengths::equal}},
             "constraint on the edge lengths; at_most: at most the length at rest; equal: the "
             "length at rest");
    p.formerly("start").choice(
        "initial_guess", start_, {{"convex", Start::convex}, {"linear", Start::linear}},
        "initial guess of the constrained steps; convex: convex fit; linear: linear shape");
    p.read("try_previous", try_previous_,
           "previous shape as an additional initial guess; the result of least energy is kept");
    p.read("fit_stiffness", options_.stiffness, "", {0.0, 1e3},
           "weight of the regularisation under the constraints");
    p.read("tension_m", options_.tension_m, "m", {1e-6, 10.0},
           "tension that pulls each edge to its length; for at_most");
    p.read("length_weight", options_.length_weight, "", {1e-3, 1e6},
           "weight of an edge, as a number of matches; for equal");
    p.read("previous", options_.previous, "", {0.0, 100.0},
           "weight of the distance of the controls from the previous shape; 0: none");
    p.read("max_iterations", options_.max_iterations, "", {1, 10000},
           "maximum number of iterations per initial guess");
    p.read("tolerance_m", options_.tolerance_m, "m", {0.0, 1.0},
           "root mean square step at which the iteration stops");
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (auto read = front_.read(in); !read) return read.error();
    const std::optional<Eigen::MatrixX3d> previous_m = previous_controls_m(in.previous_shape);
    const LengthFitter fitter(front_.mesh(), front_.inliers(), options_, previous_m);
    std::optional<LengthFit> best;
    Start best_start = start_;
    const auto offer = [&](Start start, const Eigen::MatrixX3d& start_m) {
      LengthFit fit = fitter.fit(start_m);
      if (!std::isfinite(fit.energy_m2)) return;
      if (best && best->energy_m2 <= fit.energy_m2) return;
      best = std::move(fit);
      best_start = start;
    };
    offer(start_, first_controls_m());
    if (previous_m && try_previous_) offer(Start::previous, *previous_m);
    if (!best) return no_result("the constrained steps ran away from every start");
    auto shape = solvers::shape_of_controls(in, front_.mesh(), front_.matches(), front_.inliers(),
                                            best->controls_m, kConfidence);
    if (!shape) return shape;
    shape->diag.set("iterations", best->iterations);
    shape->diag.set("energy_m2", best->energy_m2);
    shape->diag.set("start", static_cast<double>(best_start));
    return shape;
  }

 private:
  Eigen::MatrixX3d first_controls_m() const {
    if (start_ == Start::linear) return front_.inliers().shape.controls_m;
    return solvers::inextensible_fit(front_.mesh(), front_.matches(), front_.inliers(), {})
        .controls_m;
  }

  /// The controls of a shape that was measured in the last frame.
  std::optional<Eigen::MatrixX3d> previous_controls_m(const std::optional<Shape>& previous) const {
    if (!previous) return std::nullopt;
    const ShapeState state = previous->shape_state();
    const auto vertices_m = previous->vertices_m.matrix<3>();
    if ((state != ShapeState::estimated && state != ShapeState::weak) ||
        vertices_m.rows() != front_.mesh().rest_m.rows() || !vertices_m.allFinite()) {
      return std::nullopt;
    }
    Eigen::MatrixX3d controls_m(front_.mesh().control_count(), 3);
    for (Eigen::Index k = 0; k < controls_m.rows(); ++k) {
      controls_m.row(k) = vertices_m.row(front_.mesh().controls[to_index(k)]);
    }
    return controls_m;
  }

  solvers::LaplacianFront front_;
  LengthFitOptions options_;
  Start start_ = Start::linear;
  bool try_previous_ = false;
};

}  // namespace
}  // namespace weft::ngo_laplacian

using weft::ngo_laplacian::NgoLaplacian;
WEFT_PLUGIN(NgoLaplacian, "solvers/ngo_laplacian", "2.0.0",
            "Fits a Laplacian mesh under length constraints, with its own outlier rejection.")
