// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/budget.hpp>
#include <weft/sdk/solver.hpp>

#include "candidate.hpp"
#include "common/guess_search.hpp"
#include "common/hidden_bend.hpp"
#include "common/preset/preset.hpp"
#include "common/rigid/rigid_pose.hpp"
#include "confidence.hpp"
#include "covariance.hpp"
#include "fit.hpp"
#include "frame_constraints.hpp"
#include "mesh_model.hpp"
#include "relaxation.hpp"

namespace weft::particle_sft {
namespace {

using solvers::Guess;

// A shape that is further from its rays is lost.
constexpr double kLostResidualPx = 6.0;
// Share of the vertices: where more are a guess that contradicts itself, the shape is weak.
constexpr double kUnknownShare = 0.1;

/// Particle-SfT: the vertices as particles between their sightlines and the distances at rest.
class ParticleSft final : public Solver, private solvers::GuessTrial {
 public:
  static constexpr About kAbout{
      .reference =
          "paper: Ozgur, Bartoli, Particle-SfT, IJCV 123 (2017); Aranda et al., Monocular "
          "shape tracking, IROS 2020",
      .needs = "sightlines",
      .reads = "previous.shape known_points correspondences visibility"};

  explicit ParticleSft(Params& p) {
    if (declare_preset(p, Preset::weft) == Preset::author) begin_as_authors();
    p.read("damping", options_.damping, "", {0.0, 1.0}, "share of the velocity lost per iteration");
    p.read("tracked_damping", tracked_damping_, "", {0.0, 1.0},
           "damping after a previous shape that is within 3 % of the object's size in the image");
    p.read("stretch_stiffness", options_.stretch_stiffness, "", {0.0, 1.0},
           "share of an edge's length error that is corrected at once");
    p.prominent().read(
        "bend_stiffness", options_.bend_stiffness, "", {0.0, 1.0},
        "share of the distance error of opposite vertices of adjacent faces that is corrected "
        "at once");
    p.read("solver_iterations", options_.solver_iterations, "", {1, 1000},
           "number of sweeps over the distance constraints per iteration");
    p.read("max_iterations", options_.max_iterations, "", {1, 10000000},
           "maximum number of iterations per initial guess");
    p.read("tolerance_m", options_.tolerance_m, "m", {0.0, 1.0},
           "root mean square step of the vertices at which the iteration stops");
    p.read("known_radius_m", frame_options_.known_radius_m, "m", {0.0, 1.0},
           "radius of known points whose own radius is negative; 0: exact positions");
    p.read("min_sightlines", frame_options_.min_sightlines, "", {3, 1000000},
           "minimum number of sightlines for a result");
    p.formerly("start").component("initial_guess", guesses_.solver,
                                  "solver of the initial guess when there is no previous shape");
    p.formerly("start_smoothing")
        .read("initial_guess_smoothing", guesses_.smoothing, "squared mean edge lengths",
              {0.0, 1e6}, "strength of the bend smoothing of the initial guess; 0: none");
    p.read("multi_start", multi_start_,
           "further initial guesses after a loss, after a jump and after a doubtful result");
    p.read(
        "continue_hidden_bend", frame_options_.continue_hidden_bend,
        "continuation of the visible part's bend where a visibility marks the surface as hidden");
    p.read("continue_uncovered_bend", frame_options_.continue_uncovered_bend,
           "continuation of the bend also where the surface may be visible but has no matches up "
           "to its border");
    p.read("covariance", wants_covariance_, "covariance of each vertex in the result");
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (auto ready = prepare_mesh(in.templ); !ready) return ready.error();
    if (auto read = frame_.read(in, mesh_, frame_options_); !read) return read.error();
    in_ = &in;
    candidates_.clear();
    budget_.emplace(in.call);
    starts_cut_ = false;
    const auto run = guesses_.run(in, mesh_.smoother(), mesh_.at_rest(), *this);
    if (!run) return run.error();
    const Candidate* best = nullptr;
    for (const Candidate& candidate : candidates_) {
      if (!candidate.usable()) continue;
      if (best == nullptr || candidate.fit.energy < best->fit.energy) best = &candidate;
    }
    if (best == nullptr) {
      return no_result("no start led to a shape that faces the camera as the image does");
    }
    return build_shape(in, *best);
  }

 private:
  /// The constants of the program that was released with ROBUSfT. `initial_guess` is a component,
  /// which a preset does not change.
  void begin_as_authors() {
    options_.tolerance_m = 1e-5;
    guesses_.smoothing = 0.0;
    multi_start_ = false;
    frame_options_.continue_hidden_bend = false;
    frame_options_.continue_uncovered_bend = false;
  }

  Result<void> prepare_mesh(const Template& templ) {
    if (mesh_revision_ != 0 && templ.revision == mesh_revision_) return {};
    mesh_revision_ = 0;
    if (auto built = mesh_.build(templ, guesses_.smoothing); !built) return built;
    if (auto built = continuation_.build(templ); !built) return built;
    if (wants_covariance_) {
      if (auto built = covariance_.build(mesh_); !built) return built;
    }
    mesh_revision_ = templ.revision;
    frame_.system.stretch = mesh_.stretch();
    return {};
  }

  solvers::ImageMotion motion(const Points3& shape_m) override {
    return image_motion(frame_.system, pinhole(*in_), shape_m);
  }

  /// Without `multi_start` the only guess is the previous shape, or the nested solver's result if
  /// there is none.
  bool needs(Guess next, bool tracked) override {
    if (next != Guess::mirrored || !multi_start_) return false;
    if (tracked && !candidates_.back().doubtful()) return false;
    // A frame without a shape so far takes the time that it needs.
    const bool has_shape = std::any_of(candidates_.begin(), candidates_.end(),
                                       [](const Candidate& each) { return each.usable(); });
    starts_cut_ = has_shape && budget_->is_spent();
    return !starts_cut_;
  }

  SolverInput question(const SolverInput& in) const override {
    return solvers::with_radii(in, frame_.system.spheres);
  }

  bool rigid_guess(const SolverInput& in, Points3& guess_m) const override {
    if (!multi_start_) return false;
    std::vector<solvers::SeenPoint> points;
    points.reserve(frame_.system.rays.size());
    for (const RayConstraint& seen : frame_.system.rays) {
      const Eigen::Vector3d ray(seen.ray[0], seen.ray[1], seen.ray[2]);
      points.push_back({seen.vertices,
                        {seen.weights[0], seen.weights[1], seen.weights[2]},
                        project(pinhole(in), ray)});
    }
    std::optional<Points3> posed_m = solvers::posed_at_rest(points, in.camera, mesh_.rest_m());
    if (posed_m) guess_m = *std::move(posed_m);
    return posed_m.has_value();
  }

  Result<void> run(Guess guess, const Points3& from_m, bool followed) override {
    const SolverInput& in = *in_;
    RelaxationOptions options = options_;
    if (followed) options.damping = tracked_damping_;
    Candidate candidate{guess, from_m, {}, {}};
    frame_.system.bending = mesh_.bending();
    if (!frame_.hidden.empty()) {
      solvers::HiddenBend bend = continuation_.continued(from_m, frame_.hidden, mesh_.bending());
      candidate.vertices_m = std::move(bend.shape_m);
      frame_.system.bending = std::move(bend.bending);
    }
    candidate.relaxation = relaxation_.run(frame_.system, options, candidate.vertices_m,
                                           [&] { return in.call.cancelled(); });
    if (candidate.relaxation.stop == Stop::cancelled) {
      return Error{Errc::cancelled, "cancelled"};
    }
    if (!frame_.hidden.empty()) {  // distances alone do not distinguish a bend from its opposite
      solvers::HiddenBend bend = continuation_.continued(candidate.vertices_m, frame_.hidden, {});
      candidate.vertices_m = std::move(bend.shape_m);
      candidate.torn_vertices = bend.torn_vertices;
    }
    std::vector<double> depths_m;
    for (const RayConstraint& seen : frame_.system.rays) {
      depths_m.push_back(seen_point_m(seen, candidate.vertices_m).z());
    }
    if (median_in_place(depths_m) < 0.0) candidate.vertices_m *= -1.0;
    candidate.fit = assess(mesh_, frame_.system, *in.sightlines, pinhole(in), candidate.vertices_m);
    candidates_.push_back(std::move(candidate));
    return {};
  }

  Result<Shape> build_shape(const SolverInput& in, const Candidate& best) {
    if (best.fit.residual_px >= kLostResidualPx) {
      return no_result("lost: the median point is " + std::to_string(best.fit.residual_px) +
                       " px from its ray");
    }
    const ShapeEvidence evidence =
        shape_evidence(in.templ, in.camera, best.vertices_m, in.correspondences, in.sightlines);
    Shape shape;
    shape.vertices_m = make_array<double>(best.vertices_m);
    shape.confidence = confidence(best.fit, evidence) * confidence_of_filters(in.correspondences);
    const std::vector<std::uint8_t> observed =
        observed_vertices(frame_.system.rays, frame_.system.spheres, mesh_.vertex_count());
    shape.source = Array<std::uint8_t>({mesh_.vertex_count()});
    std::copy(observed.begin(), observed.end(), shape.source.data());
    if (wants_covariance_) {
      const HoldingNoise noise = holding_noise(
          {best.fit.residual_px, best.fit.strain, frame_.system.rays.size(), evidence.agreeing,
           covariance_.curvature_per_m(best.vertices_m, observed), mesh_.diagonal_m()});
      shape.covariance_m2 = Array<double>({mesh_.vertex_count(), 3, 3});
      const bool known = covariance_.compute(frame_.system, observed, pinhole(in), best.vertices_m,
                                             noise, shape.covariance_m2.data());
      if (!known) shape.covariance_m2 = {};
    }
    explain(best, shape.diag);
    if (starts_cut_) shape.state = static_cast<std::int32_t>(ShapeState::weak);
    if (frame_.inconsistent_pairs > 0) {
      return degenerate(std::move(shape),
                        std::to_string(frame_.inconsistent_pairs) +
                            " pairs of known points have larger distances than the surface allows");
    }
    const auto torn = static_cast<double>(best.torn_vertices);
    if (torn > kUnknownShare * static_cast<double>(mesh_.vertex_count())) {
      return degenerate(
          std::move(shape),
          "of " + std::to_string(best.torn_vertices) + " of " +
              std::to_string(mesh_.vertex_count()) +
              " vertices nothing is seen, and the bend around them cannot go on there");
    }
    return shape;
  }

  void explain(const Candidate& best, Diagnostics& diag) const {
    diag.set("iterations", best.relaxation.iterations);
    diag.set("stop", static_cast<double>(best.relaxation.stop));
    diag.set("last_step_m", best.relaxation.last_step_m);
    diag.set("residual_px", best.fit.residual_px);
    diag.set("strain", best.fit.strain);
    diag.set("energy", best.fit.energy);
    diag.set("start", static_cast<double>(best.guess));
    diag.set("starts_tried", static_cast<double>(candidates_.size()));
    diag.set("inconsistent_known_points", frame_.inconsistent_pairs);
    diag.set("starts_cut", starts_cut_ ? 1.0 : 0.0);
    diag.set("torn_vertices", static_cast<double>(best.torn_vertices));
  }

  static Pinhole pinhole(const SolverInput& in) {
    return {in.camera.fx, in.camera.fy, in.camera.cx, in.camera.cy};
  }

  RelaxationOptions options_;
  double tracked_damping_ = 0.008;
  FrameOptions frame_options_;
  solvers::GuessSearch guesses_;
  bool multi_start_ = true;
  bool wants_covariance_ = true;

  MeshModel mesh_;
  std::uint64_t mesh_revision_ = 0;
  solvers::BendContinuation continuation_;
  FrameConstraints frame_;
  Relaxation relaxation_;
  ShapeCovariance covariance_;
  const SolverInput* in_ = nullptr;  ///< input of the frame being solved
  std::vector<Candidate> candidates_;
  std::optional<Budget> budget_;  ///< budget of the frame
  bool starts_cut_ = false;       ///< by the budget
};

}  // namespace
}  // namespace weft::particle_sft

using weft::particle_sft::ParticleSft;
WEFT_PLUGIN(ParticleSft, "solvers/particle_sft", "1.7.0",
            "Fits a shape to sightlines by position-based dynamics, tracked from frame to frame.")
