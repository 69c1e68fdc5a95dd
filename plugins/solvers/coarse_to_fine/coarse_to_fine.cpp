// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <weft/sdk/solver.hpp>

#include "coarse_problem.hpp"

namespace weft::coarse_to_fine {
namespace {

// The base class reports these of every shape; those of the fine shape are computed anew.
constexpr std::array<std::string_view, 3> kReplaced{"diag.agreeing_matches", "diag.kept_matches",
                                                    "diag.agreeing_coverage"};

/// Runs another solver on a coarser mesh and prolongs its shape to the vertices of the fine one.
class CoarseToFine final : public Solver {
 public:
  static constexpr About kAbout{
      .reference =
          "own: Hoppe et al., Mesh optimization, SIGGRAPH (1993) for edge collapses; Duchon, "
          "Splines "
          "minimizing rotation-invariant semi-norms, LNM 571 (1977)",
      .reads = "sightlines correspondences warp image visibility known_points previous.shape"};

  explicit CoarseToFine(Params& p) {
    p.formerly("of").component("solver", of_, "solver of the coarse mesh");
    p.read("vertices", vertices_, "", {10, 1000000},
           "approximate number of vertices of the coarse mesh; a template that has no more is "
           "solved directly");
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (in.templ.vertices_m.rows() <= vertices_) {
      auto shape = of_.solve(in);
      if (shape) shape->diag = without_replaced(shape->diag);
      return shape;
    }
    if (auto ready = prepare_mesh(in.templ); !ready) return ready.error();
    const auto asked = problem_.on_coarse_mesh(in);
    if (!asked) return asked.error();
    const auto coarse = of_.solve(*asked);
    if (!coarse) return coarse.error();
    auto fine = problem_.on_fine_mesh(*coarse);
    if (!fine) return fine.error();
    fine->diag = without_replaced(coarse->diag);
    fine->diag.set("coarse_vertices", static_cast<double>(problem_.mesh().count()));
    if (const std::string& doubt = coarse.degenerate_reason(); !doubt.empty()) {
      return degenerate(*std::move(fine), doubt);
    }
    return fine;
  }

  bool joins_seams() const override { return false; }  // works in the plane of the texture

 private:
  static Diagnostics without_replaced(const Diagnostics& diagnostics) {
    Diagnostics left = diagnostics;
    std::erase_if(left.entries(), [](const NamedArray& entry) {
      const std::string_view name = entry.name;
      return std::find(kReplaced.begin(), kReplaced.end(), name) != kReplaced.end();
    });
    return left;
  }

  Result<void> prepare_mesh(const Template& templ) {
    if (revision_ != 0 && templ.revision == revision_) return {};
    revision_ = 0;
    if (auto built = problem_.build(templ, vertices_); !built) return built;
    revision_ = templ.revision;
    return {};
  }

  SolverComponent of_{"solvers/particle_sft"};
  int vertices_ = 160;

  CoarseProblem problem_;
  std::uint64_t revision_ = 0;  ///< revision of the template of the problem
};

}  // namespace
}  // namespace weft::coarse_to_fine

using weft::coarse_to_fine::CoarseToFine;
WEFT_PLUGIN(CoarseToFine, "solvers/coarse_to_fine", "1.0.0",
            "Solves a coarser mesh with another solver and interpolates the fine one.")
