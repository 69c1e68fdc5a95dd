// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <utility>
#include <weft/sdk/solver.hpp>

#include "common/convex/inextensible_surface.hpp"
#include "local_models.hpp"
#include "local_patches.hpp"

namespace weft::salzmann_local {
namespace {

// Fitted to simulated surfaces: docs/evidence/0023-confidence-of-solvers.md.
constexpr solvers::ConfidenceWeights kConfidence{.bias = -59.878,
                                                 .strain = -1.312,
                                                 .strain_p95 = -0.473,
                                                 .size = 7.046,
                                                 .agreeing = 2.183,
                                                 .share = 1.037,
                                                 .coverage = 2.190};

/// The inextensible surface of salzmann_convex, with linear local models of the bends of surfaces
/// as prior.
class SalzmannLocal final : public Solver {
 public:
  static constexpr About kAbout{.reference =
                                    "reconstruction: Salzmann, Fua, Linear Local Models for "
                                    "Monocular Reconstruction of Deformable Surfaces, "
                                    "TPAMI 33(5) (2011)",
                                .needs = "correspondences",
                                .reads = ""};

  explicit SalzmannLocal(Params& p) {
    p.read("prior_weight_px", prior_weight_px_, "px", {0.0, 10.0},
           "image error with the same cost as a bend of one standard deviation; 0: no prior");
    p.read("bend_rad", options_.turn_rad, "rad", {0.01, 100.0},
           "standard deviation of the turn of the training surfaces over the template's diagonal");
    p.read("floor", options_.floor_edges, "mean edges", {1e-4, 1.0},
           "standard deviation that is added in quadrature to each mode of a patch");
    p.read("training_shapes", options_.training_shapes, "", {50, 100000},
           "number of cylinders and cones from which the modes are learned");
    p.read("training_seed", seed_, "", {0, 1e9}, "seed of the training shapes");
    surface_.declare(p, 4);
    options_.seed = static_cast<std::uint64_t>(seed_);
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (!in.correspondences) return Error{Errc::invalid_data, "needs 'correspondences'"};
    if (auto ready = prepare_mesh(in.templ); !ready) return ready.error();
    const auto solved = surface_.solve(in, prior_weight_px_);
    if (!solved) return solved.error();
    // The prior joins hidden vertices to visible ones; nothing joins connected parts.
    const auto filled = surface_.fill(
        in.templ, solved->vertices_m,
        has_prior() ? surface_.parts_with_matches() : surface_.vertices_with_matches());
    if (!filled) return filled.error();
    auto shape = surface_.shape(in, *solved, *filled, kConfidence);
    if (shape) shape->diag.set("bend", solved->prior_rms);
    return shape;
  }

  bool joins_seams() const override { return false; }  // works in the plane of the texture

 private:
  bool has_prior() const { return prior_weight_px_ > 0.0; }

  Result<void> prepare_mesh(const Template& templ) {
    if (surface_.is_for(templ)) return {};
    auto mesh = solvers::mesh_at_rest(templ);
    if (!mesh) return mesh.error();
    if (!has_prior()) return surface_.set_mesh(templ, *std::move(mesh));
    auto prior =
        local_models(templ, local_patches(templ, mesh->topology), mesh->mean_edge_m, options_);
    if (!prior) return prior.error();
    return surface_.set_mesh(templ, *std::move(mesh), *std::move(prior));
  }

  double prior_weight_px_ = 0.05;
  std::int64_t seed_ = 2011;
  LocalModelOptions options_;
  solvers::InextensibleSurface surface_;
};

}  // namespace
}  // namespace weft::salzmann_local

using weft::salzmann_local::SalzmannLocal;
WEFT_PLUGIN(SalzmannLocal, "solvers/salzmann_local", "1.1.0",
            "Fits an inextensible surface with learned bends of its patches by one convex program.")
