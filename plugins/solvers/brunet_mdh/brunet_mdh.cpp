// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/check_sightlines.hpp>
#include <weft/geometry/known_surface.hpp>
#include <weft/sdk/solver.hpp>

#include "bending_fill.hpp"
#include "common/preset/preset.hpp"
#include "confidence.hpp"
#include "depth_admm.hpp"
#include "depth_problem.hpp"

namespace weft::brunet_mdh {
namespace {

/// Depths beyond this multiple of the median guess mean that the distances gave way altogether.
constexpr double kRunaway = 10.0;

/// The convex maximum-depth heuristic: the points of the surface are as far from the camera as
/// their rays and the distances at rest allow.
class BrunetMdh final : public Solver {
 public:
  static constexpr About kAbout{
      .reference =
          "paper: Brunet, Bartoli, Hartley, Monocular template-based 3D surface reconstruction: "
          "convex inextensible and nonconvex isometric methods, CVIU 125 (2014)",
      .needs = "sightlines",
      .reads = "known_points correspondences"};

  explicit BrunetMdh(Params& p) {
    if (declare_preset(p, Preset::weft) == Preset::author) yield_tension_ = 0.0;
    p.read("tolerance_m", options_.tolerance_m, "m", {1e-12, 1.0},
           "root mean square violation of the distances at which the iteration stops");
    p.read("max_iterations", options_.max_iterations, "", {1, 1000000},
           "maximum number of iterations of the convex solver");
    p.read("rings", rings_, "edges", {1, 100},
           "neighbourhood of a vertex within which distances are constrained");
    p.read("yield_tension", yield_tension_, "", {0.0, 1e6},
           "tension above which a distance constraint yields, relative to the tension of a flat "
           "surface seen from the front; 0: never");
    p.read("known_radius_m", known_radius_m_, "m", {0.0, 1.0},
           "radius of known points whose own radius is negative");
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (!in.sightlines) return Error{Errc::invalid_data, "needs 'sightlines'"};
    if (auto ready = prepare_surface(in.templ); !ready) return ready.error();
    const Sightlines& lines = *in.sightlines;
    auto checked = check_sightlines(lines, surface_->vertices_m().rows(), surface_->faces().rows());
    if (!checked) return checked.error();
    known_.clear();
    if (in.known_points) {
      auto known = known_surface_points(*in.known_points, in.templ, known_radius_m_);
      if (!known) return known.error();
      known_ = *std::move(known);
    }
    const std::vector<std::int64_t> chosen = choose_points(lines);
    prepare_problem(in.templ, lines, chosen);
    const std::size_t count = problem_.points.size();
    if (count < 3) {
      return no_result("too few sightlines: " + std::to_string(count) + " connected points of 3");
    }
    Points3 rays(static_cast<Eigen::Index>(count), 3);
    for (std::size_t p = 0; p < count; ++p) {
      rays.row(static_cast<Eigen::Index>(p)) =
          lines.ray.matrix<3>().row(chosen[problem_.chosen[p]]);
    }
    const auto depths = find_depths(in.call, rays);
    if (!depths) return depths.error();
    return build_shape(in, rays, *depths);
  }

 private:
  Result<void> prepare_surface(const Template& templ) {
    if (surface_ && templ.revision != 0 && templ.revision == surface_revision_) return {};
    auto surface = RestSurface::create(templ);
    if (!surface) return surface.error();
    surface_ = *std::move(surface);
    surface_revision_ = templ.revision;
    problem_ = {};
    return {};
  }

  /// Sightlines to use, ascending: the first of each vertex, and of the points in a face the most
  /// central one.
  std::vector<std::int64_t> choose_points(const Sightlines& lines) const {
    std::vector<std::int64_t> of_vertex(to_index(surface_->vertices_m().rows()), -1);
    std::vector<std::int64_t> of_face(to_index(surface_->faces().rows()), -1);
    const auto centrality = [&](std::int64_t i) {
      const double* w = lines.barycentrics.row(i);
      return std::min({w[0], w[1], w[2]});
    };
    for (std::int64_t i = 0; i < lines.count(); ++i) {
      if (lines.weight(i) == 0.0) continue;
      const bool at_vertex = lines.vertex(i) >= 0;
      std::int64_t& place =
          at_vertex ? of_vertex[to_index(lines.vertex(i))] : of_face[to_index(lines.face(i))];
      if (place < 0 || (!at_vertex && centrality(i) > centrality(place))) place = i;
    }
    std::vector<std::int64_t> chosen;
    for (const auto* places : {&of_vertex, &of_face}) {
      std::copy_if(places->begin(), places->end(), std::back_inserter(chosen),
                   [](std::int64_t i) { return i >= 0; });
    }
    std::sort(chosen.begin(), chosen.end());
    return chosen;
  }

  void prepare_problem(const Template& templ, const Sightlines& lines,
                       const std::vector<std::int64_t>& chosen) {
    std::vector<SurfacePoint> given;
    for (const std::int64_t i : chosen) {
      const double* w = lines.barycentrics.row(i);
      given.push_back({lines.vertex(i), lines.face(i), {w[0], w[1], w[2]}});
    }
    const std::size_t seen = given.size();
    for (const KnownSurfacePoint& point : known_) {
      given.push_back({point.vertex, point.face, point.weights});
    }
    const bool cached = templ.revision != 0 && problem_revision_ == templ.revision;
    if (cached && problem_.seen == seen && problem_.given == given) return;
    problem_revision_ = 0;  // until all is made
    problem_ = make_problem(*surface_, std::move(given), seen, rings_);
    if (problem_.points.size() < 3) {
      problem_revision_ = templ.revision;
      return;
    }
    admm_.set_graph(problem_.edges, static_cast<int>(problem_.points.size()));
    std::vector<SurfacePoint> placed = problem_.points;
    for (const std::size_t known : problem_.unseen) placed.push_back(problem_.given[seen + known]);
    fill_.prepare(*surface_, placed);
    problem_revision_ = templ.revision;
  }

  /// Depths with distances that may yield; with rigid ones where that has no bounded solution.
  Result<DepthResult> find_depths(const Call& call, const Points3& rays) {
    std::vector<double> spreads, guesses;
    for (const DistanceConstraint& edge : problem_.edges) {
      const double spread = (rays.row(edge.i) - rays.row(edge.j)).norm();
      if (!(spread > 1e-9)) continue;
      spreads.push_back(1.0 / spread);
      guesses.push_back(edge.rest_length_m / spread);
    }
    if (spreads.empty()) return no_result("all sightlines coincide: the depth is not bounded");
    // The edges of a point of a flat frontal surface share a total tension of 2 / spread.
    const double edges_per_point = 2.0 * static_cast<double>(problem_.edges.size()) /
                                   static_cast<double>(problem_.points.size());
    const double usual_tension = 2.0 * median_in_place(spreads) / edges_per_point;
    const double furthest_m = kRunaway * median_in_place(guesses);
    const auto cancelled = [&] { return call.cancelled(); };
    DepthOptions options = options_;
    options.slack_penalty = yield_tension_ * usual_tension;
    const std::vector<DepthAnchor> anchors = anchors_of(problem_, known_, rays);
    DepthResult result = admm_.solve(rays, options, cancelled, anchors);
    const auto ran_away = [&] {
      return *std::max_element(result.depths_m.begin(), result.depths_m.end()) > furthest_m;
    };
    if (options.slack_penalty > 0.0 && !result.cancelled && ran_away()) {
      options.slack_penalty = 0.0;
      result = admm_.solve(rays, options, cancelled, anchors);
    }
    if (result.cancelled) return Error{Errc::cancelled, "cancelled"};
    for (double& tension : result.tensions) tension /= usual_tension;
    return result;
  }

  Result<Shape> build_shape(const SolverInput& in, const Points3& rays,
                            const DepthResult& depths) const {
    Points3 positions_m(rays.rows() + static_cast<Eigen::Index>(problem_.unseen.size()), 3);
    int behind = 0;
    for (Eigen::Index p = 0; p < rays.rows(); ++p) {
      const double depth = depths.depths_m[to_index(p)];
      behind += depth < 0.0 ? 1 : 0;
      positions_m.row(p) = std::max(depth, 0.0) * rays.row(p);
    }
    for (std::size_t k = 0; k < problem_.unseen.size(); ++k) {
      positions_m.row(rays.rows() + static_cast<Eigen::Index>(k)) =
          known_[problem_.unseen[k]].centre_m.transpose();
    }
    const auto placed = fill_.place(*surface_, positions_m);
    if (!placed) return placed.error();
    if (!placed->allFinite()) return no_result("the depths are not finite");
    Shape shape;
    shape.vertices_m = make_array<double>(*placed);
    shape.source = Array<std::uint8_t>({placed->rows()}, 0);
    for (const SurfacePoint& point : problem_.points) {
      for (const std::int32_t v : surface_->support(point)) shape.source(v) = 1;
    }
    for (const KnownSurfacePoint& known : known_) {
      for (const std::int32_t v : known.vertices) shape.source(v) = 1;
    }
    const double strain = mean(strains(problem_.edges, positions_m.topRows(rays.rows())));
    const ShapeEvidence evidence =
        shape_evidence(in.templ, in.camera, *placed, in.correspondences, in.sightlines);
    shape.confidence =
        confidence(strain, evidence.agreeing) * confidence_of_filters(in.correspondences);
    if (!depths.converged || behind > 0) shape.state = static_cast<std::int32_t>(ShapeState::weak);
    explain(depths, behind, shape.diag);
    shape.diag.set("strain", strain);
    if (!depths.converged) {
      return degenerate(std::move(shape), "not converged in " + std::to_string(depths.iterations) +
                                              " iterations: raise max_iterations");
    }
    if (behind > 0) {
      return degenerate(std::move(shape),
                        std::to_string(behind) + " points came to lie behind the camera");
    }
    return shape;
  }

  void explain(const DepthResult& depths, int behind, Diagnostics& diag) const {
    const auto yielding = [&](double tension) {
      return yield_tension_ > 0.0 && tension > 0.999 * yield_tension_;
    };
    diag.set("points", static_cast<double>(problem_.points.size()));
    diag.set("dropped_points", static_cast<double>(problem_.seen - problem_.points.size()));
    diag.set("known_points", static_cast<double>(known_.size()));
    diag.set("points_behind", behind);
    diag.set("iterations", depths.iterations);
    diag.set("converged", depths.converged ? 1.0 : 0.0);
    diag.set("max_excess_m", depths.max_violation_m);
    diag.set("max_tension", *std::max_element(depths.tensions.begin(), depths.tensions.end()));
    diag.set("yielding_distances", static_cast<double>(std::count_if(
                                       depths.tensions.begin(), depths.tensions.end(), yielding)));
    Array<double> suspicion({static_cast<std::int64_t>(problem_.points.size())}, 0.0);
    for (std::size_t e = 0; e < problem_.edges.size(); ++e) {
      suspicion(problem_.edges[e].i) += depths.tensions[e];
      suspicion(problem_.edges[e].j) += depths.tensions[e];
    }
    diag.set("suspicion", std::move(suspicion));
  }

  DepthOptions options_{1e-5, 5000, 0.0};
  int rings_ = 2;
  double yield_tension_ = 8.0;
  double known_radius_m_ = 0.005;

  std::optional<RestSurface> surface_;
  std::uint64_t surface_revision_ = 0;
  std::vector<KnownSurfacePoint> known_;  ///< known points of this frame
  std::uint64_t problem_revision_ = 0;
  DepthProblem problem_;
  DepthAdmm admm_;
  BendingFill fill_;
};

}  // namespace
}  // namespace weft::brunet_mdh

using weft::brunet_mdh::BrunetMdh;
WEFT_PLUGIN(
    BrunetMdh, "solvers/brunet_mdh", "1.3.0",
    "Reconstructs the deepest shape on the sightlines by a convex program, without initial guess.")
