// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/sdk/solver.hpp>

#include "common/seen/seen_points.hpp"
#include "common/shape_signs.hpp"
#include "length_equations.hpp"
#include "observed_shapes.hpp"
#include "smooth_modes.hpp"

namespace weft::salzmann_closed_form {
namespace {

using solvers::SeenPoint;

constexpr std::size_t kFewestMatches = 10;
// Fitted to simulated surfaces: docs/evidence/0023-confidence-of-solvers.md.
constexpr solvers::ConfidenceWeights kConfidence{.bias = -26.135,
                                                 .strain = -1.799,
                                                 .strain_p95 = -1.638,
                                                 .residual = -0.327,
                                                 .size = 2.419,
                                                 .share = 0.131,
                                                 .coverage = 2.020};

/// The shapes that the image allows, combined so that edges keep their lengths.
class SalzmannClosedForm final : public Solver {
 public:
  static constexpr About kAbout{
      .reference =
          "reconstruction: Salzmann, Moreno-Noguer, Lepetit, Fua, Closed-Form "
          "Solution to Non-Rigid 3D Surface "
          "Registration, ECCV (2008)",
      .needs = "correspondences",
      .reads = ""};

  explicit SalzmannClosedForm(Params& p) {
    p.read("modes", modes_wanted_, "", {4, 60}, "number of smooth basis functions of the shapes");
    p.read("unknowns", unknowns_, "", {1, 16},
           "maximum number of combined shapes that the image allows");
    p.read("smoothing", smoothing_, "", {1e-9, 1e9},
           "weight of the bending energy, relative to squared image errors in px");
    p.read("strain", strain_, "", {1e-5, 1.0},
           "standard deviation of the relative edge-length error");
    p.read(
        "rounds", rounds_, "", {1, 20},
        "maximum number of solves; a solve is repeated while some matches have large image errors");
    p.read("outlier_px", outlier_px_, "px", {0.1, 1e6},
           "image error above which a match is excluded from the second round; halved after each "
           "round");
    p.read("polish", polish_, "", {0, 1000},
           "number of Gauss-Newton iterations after each closed-form solution");
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (!in.correspondences) return Error{Errc::invalid_data, "needs 'correspondences'"};
    if (auto ready = prepare_mesh(in.templ); !ready) return ready.error();
    auto points = solvers::seen_points(*in.correspondences, in.templ, kFewestMatches);
    if (!points) return points.error();
    auto solved = solve_for(in, *points);
    for (int round = 1; round < rounds_ && solved; ++round) {
      const double radius_px = std::ldexp(outlier_px_, 1 - round);  // halved each time
      std::vector<SeenPoint> near =
          solvers::points_within(*points, in.camera, solved->vertices_m, radius_px);
      if (near.size() == points->size() || near.size() < kFewestMatches) break;
      auto again = solve_for(in, near);
      if (!again) break;
      *points = std::move(near);
      solved = std::move(again);
    }
    if (!solved) return solved.error();
    return build_shape(in, *points, *solved);
  }

 private:
  struct Solved {
    Points3 vertices_m;  ///< [V,3] m, camera frame
    Eigen::Index unknowns = 0;
    double rank_residual = 0.0, cost = 0.0;
  };

  Result<Solved> solve_for(const SolverInput& in, const std::vector<SeenPoint>& points) const {
    const ObservedShapes observed = observed_shapes(
        points, in.camera, in.templ.vertices_m.matrix<3>(), modes_, smoothing_, unknowns_);
    if (observed.costs.size() == 0) return no_result("the matches coincide in the image");
    const LengthEquations equations(observed, edges_, strain_);
    const Eigen::VectorXd beta =
        best_combination(equations, static_cast<int>(observed.costs.size()), polish_);
    if (beta.size() == 0) return no_result("no shape that the image allows has the lengths");
    const Eigen::VectorXd flat = observed.shapes.leftCols(beta.size()) * beta;
    Solved solved;
    solved.vertices_m = Eigen::Map<const Points3>(flat.data(), flat.size() / 3, 3);
    if (solved.vertices_m.col(2).sum() < 0.0) solved.vertices_m *= -1.0;
    solved.unknowns = beta.size();
    solved.rank_residual = equations.rank_residual(static_cast<int>(beta.size()));
    solved.cost = equations.value(beta);
    return solved;
  }

  Result<void> prepare_mesh(const Template& templ) {
    if (templ.revision != 0 && templ.revision == revision_) return {};
    revision_ = 0;  // until all is made
    const auto vertices_m = templ.vertices_m.matrix<3>();
    const auto faces = templ.faces.matrix<3>();
    if (auto valid = validate_mesh(vertices_m, faces); !valid) return valid.error();
    const auto topology = build_topology(faces, vertices_m.rows());
    if (!topology) return topology.error();
    auto edges = distance_constraints(topology->edges, vertices_m);
    if (!edges) return edges.error();
    edges_ = *std::move(edges);
    modes_ = smooth_modes(vertices_m, bending_hinges(vertices_m, faces, *topology), modes_wanted_);
    revision_ = templ.revision;
    return {};
  }

  Result<Shape> build_shape(const SolverInput& in, const std::vector<SeenPoint>& points,
                            const Solved& solved) const {
    const Points3& vertices_m = solved.vertices_m;
    if (!(vertices_m.allFinite() && vertices_m.col(2).minCoeff() > 0.0)) {
      return no_result("the surface reaches behind the camera");
    }
    Shape shape;
    shape.vertices_m = make_array<double>(vertices_m);
    const std::vector<std::uint8_t> seen = solvers::vertices_seen(points, vertices_m.rows());
    shape.source = Array<std::uint8_t>({vertices_m.rows()});
    std::copy(seen.begin(), seen.end(), shape.source.data());
    const solvers::ShapeSigns signs = solvers::shape_signs(in, edges_, vertices_m);
    shape.confidence = solvers::confidence(signs, kConfidence, in.correspondences);
    shape.diag.set("points", static_cast<double>(points.size()));
    shape.diag.set("unknowns", static_cast<double>(solved.unknowns));
    shape.diag.set("rank_residual", solved.rank_residual);
    shape.diag.set("cost", solved.cost);
    signs.tell(shape.diag);
    return shape;
  }

  int modes_wanted_ = 20;
  int unknowns_ = 16;
  double smoothing_ = 10.0;
  double strain_ = 0.005;
  int polish_ = 10;
  int rounds_ = 4;
  double outlier_px_ = 20.0;

  std::uint64_t revision_ = 0;  ///< revision of the template to which all of this belongs
  std::vector<DistanceConstraint> edges_;
  SmoothModes modes_;
};

}  // namespace
}  // namespace weft::salzmann_closed_form

using weft::salzmann_closed_form::SalzmannClosedForm;
WEFT_PLUGIN(SalzmannClosedForm, "solvers/salzmann_closed_form", "1.1.0",
            "Computes an inextensible surface in closed form as a combination of smooth shapes.")
