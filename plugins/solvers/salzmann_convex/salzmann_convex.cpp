// SPDX-License-Identifier: Apache-2.0
#include <utility>
#include <weft/sdk/solver.hpp>

#include "common/convex/inextensible_surface.hpp"
#include "common/preset/preset.hpp"

namespace weft::salzmann_convex {
namespace {

// Fitted to simulated surfaces: docs/evidence/0023-confidence-of-solvers.md.
constexpr solvers::ConfidenceWeights kConfidence{.bias = -42.060,
                                                 .strain = -1.321,
                                                 .roughness = -0.966,
                                                 .size = 4.234,
                                                 .agreeing = 1.776,
                                                 .share = 0.149,
                                                 .coverage = 1.875};

/// Inextensible surfaces by one convex program: edges may shorten, as they do across a fold.
class SalzmannConvex final : public Solver {
 public:
  static constexpr About kAbout{
      .reference =
          "paper: Salzmann, Fua, Reconstructing Sharply Folding Surfaces: A Convex Formulation, "
          "CVPR (2009)",
      .needs = "correspondences",
      .reads = ""};

  explicit SalzmannConvex(Params& p) {
    const int rounds = declare_preset(p) == Preset::author ? 1 : 4;
    surface_.declare(p, rounds);
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (!in.correspondences) return Error{Errc::invalid_data, "needs 'correspondences'"};
    if (!surface_.is_for(in.templ)) {
      auto mesh = solvers::mesh_at_rest(in.templ);
      if (!mesh) return mesh.error();
      if (auto set = surface_.set_mesh(in.templ, *std::move(mesh)); !set) return set.error();
    }
    const auto solved = surface_.solve(in);
    if (!solved) return solved.error();
    const auto filled =
        surface_.fill(in.templ, solved->vertices_m, surface_.vertices_with_matches());
    if (!filled) return filled.error();
    return surface_.shape(in, *solved, *filled, kConfidence);
  }

 private:
  solvers::InextensibleSurface surface_;
};

}  // namespace
}  // namespace weft::salzmann_convex

using weft::salzmann_convex::SalzmannConvex;
WEFT_PLUGIN(SalzmannConvex, "solvers/salzmann_convex", "2.0.0",
            "Fits an inextensible surface, with sharp folds if needed, by one convex program.")
