// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/shape_evidence.hpp>
#include <weft/sdk/solver.hpp>

#include "common/seen/seen_points.hpp"
#include "confidence.hpp"
#include "match_sightlines.hpp"
#include "refinement.hpp"

namespace weft::brunet_refine {
namespace {

constexpr std::size_t kFewestMatches = 10;

/// A smooth isometric surface on the matches by nonlinear least squares, from another solver's
/// shape.
class BrunetRefine final : public Solver {
 public:
  static constexpr About kAbout{
      .reference =
          "paper: Brunet, Bartoli, Hartley, Monocular template-based 3D surface reconstruction: "
          "convex inextensible and nonconvex isometric methods, CVIU 125 (2014)",
      .needs = "correspondences",
      .reads = "sightlines known_points previous.shape"};

  explicit BrunetRefine(Params& p) {
    p.formerly("start").component("initial_guess", start_,
                                  "solver of the initial shape that is refined");
    p.read("control", surface_options_.control, "", {4, 40},
           "number of control points of the surface along u and along v");
    p.read("places_per_cell", surface_options_.places_per_cell, "", {1, 10},
           "number of points along each side of a knot cell at which lengths are constrained");
    p.read("match_noise_px", fit_options_.match_noise_px, "px", {1e-3, 100.0},
           "standard deviation of a match along u and v");
    p.read("outlier_px", fit_options_.outlier_px, "px", {1e-3, 1e6},
           "distance beyond which the cost of a match grows linearly");
    p.read("strain", surface_options_.strain, "", {1e-6, 1.0},
           "standard deviation of the relative length error of the surface");
    p.read("smoothing", surface_options_.smoothing, "", {0.0, 1e6},
           "weight of the bending energy, the integral of the squared second derivatives");
    p.read("max_iterations", fit_options_.max_iterations, "", {1, 100000},
           "maximum number of refinement iterations");
    p.read("tolerance", fit_options_.tolerance, "", {1e-15, 0.1},
           "relative decrease of the energy at which the refinement stops");
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (!in.correspondences) return Error{Errc::invalid_data, "needs 'correspondences'"};
    if (auto ready = prepare_template(in.templ); !ready) return ready.error();
    const auto points = solvers::seen_points(*in.correspondences, in.templ, kFewestMatches);
    if (!points) return points.error();
    const auto start = start_.solve(asked_of_start(in));
    if (!start) return start.error();
    const auto start_m = start->vertices_m.matrix<3>();
    if (start_m.rows() != in.templ.vertices_m.rows()) {
      return Error{Errc::plugin_failure, "the start has another number of vertices"};
    }
    if (!start_m.allFinite()) return no_result("the start is not finite");
    const auto refined = surface_.refine(*points, in.camera, start_m, fit_options_);
    if (!refined) return refined.error();
    return build_shape(in, *points, *refined);
  }

  bool joins_seams() const override { return false; }  // works in the plane of the texture

 private:
  Result<void> prepare_template(const Template& templ) {
    if (templ.revision != 0 && templ.revision == revision_) return {};
    revision_ = 0;  // until all is made
    if (auto set = surface_.set_template(templ, surface_options_); !set) return set;
    const auto vertices_m = templ.vertices_m.matrix<3>();
    const auto topology = build_topology(templ.faces.matrix<3>(), vertices_m.rows());
    if (!topology) return topology.error();
    auto edges = distance_constraints(topology->edges, vertices_m);
    if (!edges) return edges.error();
    edges_ = *std::move(edges);
    revision_ = templ.revision;
    return {};
  }

  /// The start is given sightlines of the matches where none are wired.
  static SolverInput asked_of_start(const SolverInput& in) {
    SolverInput asked = in;
    if (!asked.sightlines) {
      asked.sightlines = match_sightlines(*in.correspondences, in.camera, in.templ.faces.rows());
    }
    return asked;
  }

  Result<Shape> build_shape(const SolverInput& in, const std::vector<solvers::SeenPoint>& points,
                            const RefinedSurface& refined) const {
    const Points3& vertices_m = refined.vertices_m;
    if (!(vertices_m.allFinite() && vertices_m.col(2).minCoeff() > 0.0)) {
      return no_result("the surface reaches behind the camera");
    }
    Shape shape;
    shape.vertices_m = make_array<double>(vertices_m);
    const auto seen = solvers::vertices_seen(points, vertices_m.rows());
    shape.source = Array<std::uint8_t>({vertices_m.rows()});
    std::copy(seen.begin(), seen.end(), shape.source.data());
    const double strain = mean(strains(edges_, vertices_m));
    const double residual_px =
        median(solvers::reprojection_errors_px(points, in.camera, vertices_m));
    const ShapeEvidence evidence =
        shape_evidence(in.templ, in.camera, vertices_m, in.correspondences, in.sightlines);
    shape.confidence = confidence({strain, residual_px, evidence.coverage}) *
                       confidence_of_filters(in.correspondences);
    shape.diag.set("points", static_cast<double>(points.size()));
    shape.diag.set("iterations", refined.iterations);
    shape.diag.set("converged", refined.converged ? 1.0 : 0.0);
    shape.diag.set("start_energy", refined.energy.front());
    shape.diag.set("energy", refined.energy.back());
    shape.diag.set("metric_rms", refined.metric_rms);
    shape.diag.set("residual_px", residual_px);
    shape.diag.set("strain", strain);
    if (refined.converged) return shape;
    shape.state = static_cast<std::int32_t>(ShapeState::weak);
    return degenerate(std::move(shape), "not converged in " + std::to_string(refined.iterations) +
                                            " iterations: raise max_iterations or tolerance");
  }

  SolverComponent start_{"solvers/brunet_mdh"};
  SurfaceOptions surface_options_;
  FitOptions fit_options_;

  std::uint64_t revision_ = 0;  ///< revision of the template to which all of this belongs
  std::vector<DistanceConstraint> edges_;
  SplineRefinement surface_;
};

}  // namespace
}  // namespace weft::brunet_refine

using weft::brunet_refine::BrunetRefine;
WEFT_PLUGIN(BrunetRefine, "solvers/brunet_refine", "1.0.0",
            "Fits an isometric spline surface to the matches by nonlinear least squares.")
