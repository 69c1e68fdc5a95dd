// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/sdk/solver.hpp>

#include "common/least_bending.hpp"
#include "common/seen_points.hpp"
#include "common/strain_confidence.hpp"
#include "inextensible_program.hpp"

namespace weft::salzmann_convex {
namespace {

using solvers::SeenPoint;

constexpr std::size_t kFewestMatches = 10;
constexpr double kUsualStrain = 0.03;

/// Inextensible surfaces by one convex program: edges may shorten, as they do across a fold.
class SalzmannConvex final : public Solver {
 public:
  static constexpr About kAbout{
      .reference =
          "Salzmann, Fua, Reconstructing Sharply Folding Surfaces: A Convex Formulation, "
          "CVPR (2009)",
      .needs = "correspondences",
      .reads = ""};

  explicit SalzmannConvex(Params& p) {
    p.read("depth_weight_px", options_.depth_weight_px, "px", {1e-6, 1e6},
           "of the distances of all matches against the norm of their errors in the image");
    p.read("rounds", rounds_, "", {1, 20},
           "how often the program is solved at most: again while matches are far off");
    p.read("outlier_px", outlier_px_, "px", {0.1, 1e6},
           "matches that are further off are left out of the second round; halved after each");
    p.read("tolerance", options_.tolerance, "", {1e-10, 0.1},
           "how near the optimum is, in parts of the distance");
    p.read("max_iterations", options_.max_iterations, "", {1, 1000000}, "Newton steps of a round");
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (!in.correspondences) return Error{Errc::invalid_data, "needs 'correspondences'"};
    if (auto ready = prepare_mesh(in.templ); !ready) return ready.error();
    auto points = solvers::seen_points(*in.correspondences, in.templ, kFewestMatches);
    if (!points) return points.error();
    points_ = *std::move(points);
    weights_.assign(points_.size(), 1.0);
    auto solved = program_.solve(points_, weights_, in.camera, options_);
    if (!solved) return solved.error();
    for (int round = 1; round < rounds_; ++round) {
      const double radius_px = std::ldexp(outlier_px_, 1 - round);  // halved each time
      if (!weigh_again(solved->vertices_m, in.camera, radius_px)) break;
      auto again = program_.solve(points_, weights_, in.camera, options_);
      if (!again) break;
      solved = std::move(again);
    }
    return build_shape(in, *solved);
  }

 private:
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
    hinges_ = bending_hinges(vertices_m, faces, *topology);
    mean_edge_m_ = mean_edge_length(vertices_m, topology->edges);
    if (auto set = program_.set_mesh(vertices_m, *std::move(edges)); !set) return set.error();
    revision_ = templ.revision;
    return {};
  }

  /// Leaves out matches that are off by more than a radius and weighs the others by exp(-r / median
  /// r). False, and nothing is changed, where none is off by as much or too few are left.
  bool weigh_again(const Points3& vertices_m, const Camera& camera, double radius_px) {
    const std::vector<double> errors_px =
        solvers::reprojection_errors_px(points_, camera, vertices_m);
    std::vector<SeenPoint> near;
    std::vector<double> near_px;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!(errors_px[i] <= radius_px)) continue;
      near.push_back(points_[i]);
      near_px.push_back(errors_px[i]);
    }
    if (near.size() == points_.size() || near.size() < kFewestMatches) return false;
    const double usual_px = median(near_px) + 1e-9;
    points_ = std::move(near);
    weights_.clear();
    // Below exp(-20) a match is as good as none, and the program is badly scaled.
    for (const double r : near_px) weights_.push_back(std::exp(-std::min(r / usual_px, 20.0)));
    return true;
  }

  Result<Shape> build_shape(const SolverInput& in, const ProgramResult& solved) const {
    const auto rest_m = in.templ.vertices_m.matrix<3>();
    const std::vector<std::uint8_t> seen = solvers::vertices_seen(points_, rest_m.rows());
    const auto filled =
        solvers::fill_with_least_bending(rest_m, hinges_, mean_edge_m_, seen, solved.vertices_m);
    if (!filled) return filled.error();
    if (!(filled->allFinite() && filled->col(2).minCoeff() > 0.0)) {
      return no_result("the surface reaches behind the camera");
    }
    Shape shape;
    shape.vertices_m = make_array<double>(*filled);
    shape.source = Array<std::uint8_t>({filled->rows()});
    std::copy(seen.begin(), seen.end(), shape.source.data());
    const double strain = mean(strains(program_.edges(), *filled));
    const ShapeEvidence evidence =
        shape_evidence(in.templ, in.camera, *filled, in.correspondences, in.sightlines);
    shape.confidence = solvers::strain_confidence(strain, kUsualStrain, evidence.agreeing) *
                       confidence_of_filters(in.correspondences);
    explain(solved, shape.diag);
    shape.diag.set("strain", strain);
    if (solved.converged) return shape;
    shape.state = static_cast<std::int32_t>(ShapeState::weak);
    return degenerate(std::move(shape), "not converged in " + std::to_string(solved.iterations) +
                                            " iterations: raise max_iterations or tolerance");
  }

  void explain(const ProgramResult& solved, Diagnostics& diag) const {
    diag.set("points", static_cast<double>(points_.size()));
    diag.set("iterations", solved.iterations);
    diag.set("converged", solved.converged ? 1.0 : 0.0);
    diag.set("objective_m", solved.objective_m);
    diag.set("gap_m", solved.gap_m);
    diag.set("depth_weight_px", solved.depth_weight_px);
  }

  ProgramOptions options_;
  int rounds_ = 4;
  double outlier_px_ = 20.0;

  std::uint64_t revision_ = 0;  ///< of the template that all of this is for
  std::vector<BendingHinge> hinges_;
  double mean_edge_m_ = 1.0;
  InextensibleProgram program_;
  std::vector<SeenPoint> points_;  ///< of this frame, those that count
  std::vector<double> weights_;    ///< [n] of these
};

}  // namespace
}  // namespace weft::salzmann_convex

using weft::salzmann_convex::SalzmannConvex;
WEFT_PLUGIN(SalzmannConvex, "solvers/salzmann_convex", "1.0.0",
            "Inextensible surface, also with sharp folds, by one convex program on the matches.")
