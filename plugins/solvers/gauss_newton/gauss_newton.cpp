// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/solver.hpp>

#include "candidate.hpp"
#include "common/guess_search.hpp"
#include "common/rigid/rigid_pose.hpp"
#include "confidence.hpp"
#include "covariance.hpp"
#include "fit.hpp"
#include "frame.hpp"
#include "frontal_guess.hpp"
#include "outline/outline_pose.hpp"
#include "outline/outline_start.hpp"
#include "search.hpp"

namespace weft::gauss_newton {
namespace {

using solvers::Guess;

// A shape that is further from what was seen is lost.
constexpr double kLostResidualPx = 6.0;
// Below this number, matches do not always determine to which side a surface bends.
constexpr std::size_t kFewObservations = 150;
// Number of neighbouring points of an outline with the same error.
constexpr double kOutlineCoherence = 8.0;

/// Robust nonlinear least squares on the vertices: matches against lengths along the surface.
class GaussNewton final : public Solver, private solvers::GuessTrial {
 public:
  static constexpr About kAbout{
      .reference =
          "own: Collins, Bartoli, Realtime Shape-from-Template, ISMAR (2015); George, Nested "
          "dissection of a regular finite element mesh, SIAM Journal on Numerical Analysis 10 "
          "(1973)",
      .reads = "correspondences sightlines previous.shape known_points visibility object_mask"};

  explicit GaussNewton(Params& p) {
    search_.scales.trust = {3.0, true};
    FrameOptions& frame = frame_.options;
    p.choice("data", frame.seen.data,
             {{"matches", Data::matches}, {"sightlines", Data::sightlines}, {"both", Data::both}},
             "measurements of the data term; matches: the matches if they are connected, else the "
             "sightlines");
    p.prominent().read("match_noise_px", frame.seen.match_noise_px, "px", {1e-3, 100.0},
                       "standard deviation, along u and v, of a match without a covariance");
    p.read("covariance_noise_px", frame.seen.covariance_noise_px, "px", {0.0, 100.0},
           "standard deviation that is added to the covariance of a match");
    p.read("sightline_noise_px", frame.seen.sightline_noise_px, "px", {1e-3, 100.0},
           "standard deviation of a sightline of weight 1");
    p.read("outlier", search_.scales.trust.scale, "", {0.1, 1e6},
           "residual, in standard deviations, at which the robust loss reduces the weight to 1/4");
    p.read("strain", search_.scales.strain, "", {1e-5, 1.0},
           "standard deviation of the relative edge-length error");
    p.read("pair_strain", search_.scales.pair_strain, "", {0.0, 1.0},
           "standard deviation of the relative distance error of opposite vertices of adjacent "
           "faces; 0: no such term");
    p.prominent().read(
        "bend_rad", search_.scales.bend_rad, "rad", {0.0, 100.0},
        "standard deviation of the bend of a mesh square from the expected bend; 0: no such term");
    p.read(
        "previous_m", search_.scales.previous_m, "m", {0.0, 100.0},
        "standard deviation of the distance of a vertex from the previous shape; 0: no such term");
    p.read("known_radius_m", frame.known_radius_m, "m", {0.0, 1.0},
           "radius of known points whose own radius is negative; 0: exact positions");
    p.read("min_sightlines", frame.min_sightlines, "", {3, 1000000},
           "minimum number of measured points for a result");
    p.read("max_iterations", search_.options.max_iterations, "", {1, 1000000},
           "maximum number of Gauss-Newton iterations per initial guess");
    p.read("tolerance_m", search_.options.tolerance_m, "m", {0.0, 1.0},
           "root mean square step of the vertices at which the iteration stops");
    p.formerly("start").component("initial_guess", guesses_.solver,
                                  "solver of the initial guess when there is no previous shape");
    p.formerly("go_on").read(
        "previous_only", previous_only_,
        "previous shape as the only initial guess; for a shape from an earlier solver of the "
        "same frame");
    p.formerly("start_smoothing")
        .read("initial_guess_smoothing", guesses_.smoothing, "squared mean edge lengths",
              {0.0, 1e6}, "strength of the bend smoothing of the initial guess; 0: none");
    p.read(
        "continue_hidden_bend", frame.continue_hidden_bend,
        "continuation of the visible part's bend where a visibility marks the surface as hidden");
    p.read("continue_uncovered_bend", frame.continue_uncovered_bend,
           "continuation of the bend also where the surface may be visible but has no matches up "
           "to its border");
    p.read("scale_noise", scale_noise_, "", {0.0, 1.0},
           "relative standard deviation of the template's size and of the focal length, for the "
           "covariance");
    p.read("covariance", wants_covariance_, "covariance of each vertex in the result");
    OutlineScales& outline = search_.scales.outline;
    p.read("outline_noise_px", outline.noise_px, "px", {1e-2, 100.0},
           "standard deviation of a point of the mask's outline, across the outline");
    p.read("outline_outlier_px", outline.outlier_px, "px", {0.1, 1000.0},
           "distance between mesh border and outline from which on it has no influence");
    p.read("outline_reach_px", outline.reach_px, "px", {1.0, 1000.0},
           "distance within which the mesh border looks for the outline in the first iterations");
    p.read("outline_weight", outline.share, "", {0.0, 1000.0},
           "factor on the weight of the outline; 0: no such term");
    p.read("outline_alone", frame.outline_alone,
           "shape from the outline alone in frames with too few matches");
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (auto ready = prepare_mesh(in.templ); !ready) return ready.error();
    if (auto read = frame_.read(in, mesh_); !read) return read.error();
    tried_ = 0;
    best_ = -1;
    search_.options.budget = &budget_.emplace(in.call);
    starts_cut_ = false;
    if (frame_.is_outline_alone) return solve_by_outline(in);
    const auto run = guesses_.run(in, mesh_.smoother, mesh_.at_rest(), *this);
    if (!run) return run.error();
    if (best_ >= 0 && frame_.data.observations.size() < kFewObservations && is_in_time()) {
      run_from(Guess::mirrored, solvers::bend_mirrored(candidates_[to_index(best_)].vertices_m));
    }
    if (best_ < 0) {
      return no_result("no start led to a shape that faces the camera as the image does");
    }
    return build_shape(in, candidates_[to_index(best_)]);
  }

 private:
  Result<void> prepare_mesh(const Template& templ) {
    if (mesh_revision_ != 0 && templ.revision == mesh_revision_) return {};
    mesh_revision_ = 0;
    if (auto built = mesh_.build(templ, guesses_.smoothing); !built) return built;
    if (auto ready = search_.prepare(templ, mesh_); !ready) return ready;
    if (wants_covariance_) covariance_.prepare(mesh_);
    mesh_revision_ = templ.revision;
    return {};
  }

  solvers::ImageMotion motion(const Points3& shape_m) override {
    return gauge_.motion(mesh_, frame_.data, shape_m);
  }

  Result<void> run(Guess guess, const Points3& from_m, bool) override {
    run_from(guess, from_m);
    return {};
  }

  bool needs(Guess next, bool tracked) override {
    return is_in_doubt(next, tracked) && is_in_time();
  }

  /// True if one more start may be tried. A frame without a shape so far takes the time that it
  /// needs.
  bool is_in_time() {
    const bool is_cut = best_ >= 0 && budget_->is_spent();
    starts_cut_ = starts_cut_ || is_cut;
    return !is_cut;
  }

  bool is_in_doubt(Guess next, bool tracked) const {
    if (next == Guess::mirrored) {
      if (previous_only_ && best_ >= 0) return false;
      return !tracked || candidates_.front().doubtful();
    }
    if (next == Guess::rough) return candidates_[tried_ - 1].doubtful();
    return candidates_[to_index(std::max(best_, 0))].doubtful();
  }

  /// The nested solver may need sightlines, which the matches give.
  SolverInput question(const SolverInput& in) const override {
    SolverInput question = solvers::with_radii(in, frame_.data.spheres);
    if (!question.sightlines) question.sightlines = sightlines_of(frame_.data, mesh_.faces);
    return question;
  }

  bool rigid_guess(const SolverInput& in, Points3& guess_m) const override {
    std::optional<Points3> posed_m =
        mesh_.is_flat ? frontal_guess(frame_.data, mesh_)
                      : solvers::posed_at_rest(seen_points(), in.camera, mesh_.rest_m);
    if (!posed_m) return false;
    guess_m = *std::move(posed_m);
    return true;
  }

  std::vector<solvers::SeenPoint> seen_points() const {
    std::vector<solvers::SeenPoint> points;
    points.reserve(frame_.data.observations.size());
    for (const SeenFace& seen : frame_.data.faces) {
      const auto corners = mesh_.faces.row(seen.face);
      for (std::size_t i = seen.first; i < seen.end; ++i) {
        const Observation& o = frame_.data.observations[i];
        points.push_back({{corners[0], corners[1], corners[2]},
                          {o.weights[0], o.weights[1], o.weights[2]},
                          {o.seen_px[0], o.seen_px[1]}});
      }
    }
    return points;
  }

  void run_from(Guess guess, const Points3& from_m) {
    Candidate& candidate = candidates_[tried_];
    candidate.guess = guess;
    candidate.vertices_m = from_m;
    if (gauge_.is_behind(mesh_, frame_.data, from_m)) candidate.vertices_m *= -1.0;
    search_.run(frame_, candidate);
    candidate.fit = gauge_.measure(mesh_, frame_.data, search_.energy(), candidate.vertices_m);
    if (candidate.usable()) keep_if_better(candidate);
    ++tried_;
  }

  /// `candidate` is the one at index tried_.
  void keep_if_better(const Candidate& candidate) {
    if (best_ < 0 || candidate.result.energy < candidates_[to_index(best_)].result.energy) {
      best_ = static_cast<int>(tried_);
    }
  }

  /// From the previous shape, else from the template placed in the mask. Then from the result, bent
  /// to the other side.
  Result<Shape> solve_by_outline(const SolverInput& in) {
    const auto& previous = in.previous_shape;
    const bool follows = previous && previous->vertices_m.rows() == mesh_.vertex_count() &&
                         (previous->shape_state() == ShapeState::estimated ||
                          previous->shape_state() == ShapeState::weak);
    if (follows && previous->vertices_m.matrix<3>().allFinite()) {
      fit_outline(Guess::previous, previous->vertices_m.matrix<3>());
    }
    if (best_ < 0) {
      const auto placed_m = outline_start(*in.object_mask, frame_.data.camera, mesh_);
      if (!placed_m) return no_result("too few matches, and the mask shows no object");
      fit_outline(Guess::rigid, *placed_m);
    }
    if (best_ >= 0) {
      fit_outline(Guess::mirrored, solvers::bend_mirrored(candidates_[to_index(best_)].vertices_m));
    }
    if (best_ < 0) return no_result("lost: too few matches, and no shape fits the mask's outline");
    return build_shape(in, candidates_[to_index(best_)]);
  }

  void fit_outline(Guess guess, const Points3& from_m) {
    constexpr double kMostMissed = 0.5;
    Candidate& candidate = candidates_[tried_];
    candidate.guess = guess;
    candidate.vertices_m = from_m;
    search_.run(frame_, candidate);
    candidate.fit = measured_outline(candidate.vertices_m);
    if (candidate.usable() && candidate.fit.far_share <= kMostMissed) keep_if_better(candidate);
    ++tried_;
  }

  Fit measured_outline(const Points3& vertices_m) {
    const Scales scales = search_.final_scales();
    search_.energy().meet_outline(frame_.data, scales, vertices_m);
    return gauge_.measure_outline(mesh_, frame_.data, scales.outline.noise_px, search_.energy(),
                                  vertices_m);
  }

  Result<Shape> build_shape(const SolverInput& in, const Candidate& best) {
    if (best.fit.residual_px >= kLostResidualPx) {
      return no_result("lost: the median point is " + std::to_string(best.fit.residual_px) +
                       " px from where it was seen");
    }
    const ShapeEvidence evidence =
        shape_evidence(in.templ, in.camera, best.vertices_m, in.correspondences, in.sightlines);
    Shape shape;
    shape.vertices_m = make_array<double>(best.vertices_m);
    const Rival rival = rival_of(best);
    shape.confidence = confidence(best.fit, evidence) * confidence_of_filters(in.correspondences) *
                       (1.0 - rival.probability);
    shape.source = Array<std::uint8_t>({mesh_.vertex_count()});
    std::copy(frame_.observed.begin(), frame_.observed.end(), shape.source.data());
    if (wants_covariance_) {
      add_covariance(best, shape);
      if (shape.covariance_m2.present()) add_camera_noise(in.camera, best, shape);
      if (rival.shape != nullptr && shape.covariance_m2.present()) add_rival(best, rival, shape);
    }
    // Another start might have led to another shape.
    if (starts_cut_) shape.state = static_cast<std::int32_t>(ShapeState::weak);
    explain(best, shape.diag);
    shape.diag.set("rival", rival.probability);
    if (frame_.data.outline.present()) explain_outline(best, shape.diag);
    if (frame_.inconsistent_pairs > 0) {
      return degenerate(std::move(shape),
                        std::to_string(frame_.inconsistent_pairs) +
                            " pairs of known points have larger distances than the surface allows");
    }
    return shape;
  }

  /// Another shape that explains the image nearly as well, such as one that bends to the other
  /// side.
  struct Rival {
    const Candidate* shape = nullptr;
    double probability = 0.0;  ///< [] that it, and not the best one, is right
  };

  /// The rival is the likeliest candidate whose mean distance from the best is more than 2 % of the
  /// diagonal. The odds of two shapes are exp(-(difference of their energies) / (2 noise^2)).
  Rival rival_of(const Candidate& best) const {
    constexpr double kOther = 0.02;
    const double noise = observed_noise(best.fit.residual, best.fit.coherence);
    Rival rival;
    for (std::size_t k = 0; k < tried_; ++k) {
      const Candidate& other = candidates_[k];
      if (&other == &best || !other.usable() || other.fit.residual_px >= kLostResidualPx) continue;
      const double distance_m = (other.vertices_m - best.vertices_m).rowwise().norm().mean();
      if (distance_m <= kOther * mesh_.diagonal_m()) continue;
      const double logit = 0.5 * (other.result.energy - best.result.energy) / (noise * noise);
      const double probability = logistic(-logit);
      if (probability > rival.probability) rival = {&other, probability};
    }
    return rival;
  }

  static void add_rival(const Candidate& best, const Rival& rival, Shape& shape) {
    const Points3 distance_m = rival.shape->vertices_m - best.vertices_m;
    for (Eigen::Index v = 0; v < distance_m.rows(); ++v) {
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          shape.covariance_m2.row(v)[3 * i + j] +=
              rival.probability * distance_m(v, i) * distance_m(v, j);
        }
      }
    }
  }

  /// A focal length that is assumed and not measured moves all depths in proportion.
  static void add_camera_noise(const Camera& camera, const Candidate& best, Shape& shape) {
    const auto assumed = CameraAssumption::of(camera);
    if (!assumed) return;
    for (Eigen::Index v = 0; v < best.vertices_m.rows(); ++v) {
      const double depth_sd_m = best.vertices_m(v, 2) * assumed->focal_sd_px / camera.fx;
      shape.covariance_m2.row(v)[8] += depth_sd_m * depth_sd_m;
    }
  }

  void add_covariance(const Candidate& best, Shape& shape) {
    search_.energy().follow(best.vertices_m);
    HoldingNoise noise = holding_noise(
        {best.fit.residual, best.fit.coherence, best.fit.strain, scale_noise_,
         frame_.data.observations.size(), frame_.observed.size(),
         covariance_.curvature_per_m(best.vertices_m, frame_.observed), mesh_.diagonal_m()});
    if (frame_.data.outline.present()) {
      noise.outline = observed_noise(measured_outline(best.vertices_m).residual, kOutlineCoherence);
    }
    shape.covariance_m2 = Array<double>({mesh_.vertex_count(), 3, 3});
    const bool known =
        covariance_.compute(frame_.data, search_.scales, frame_.observed, best.vertices_m, noise,
                            search_.energy(), search_.factor(), shape.covariance_m2.data());
    if (!known) shape.covariance_m2 = {};
  }

  void explain_outline(const Candidate& best, Diagnostics& diag) {
    const Fit fit = measured_outline(best.vertices_m);
    const OutlineTerm& outline = search_.energy().outline();
    diag.set("outline_points", static_cast<double>(outline.points().size()));
    diag.set("outline_residual_px", fit.residual_px);
    diag.set("outline_missed", fit.far_share);
    diag.set("outline_weight", outline.share);
  }

  void explain(const Candidate& best, Diagnostics& diag) const {
    diag.set("iterations", best.result.iterations);
    diag.set("approach_iterations", best.approach_iterations);
    diag.set("stop", static_cast<double>(best.result.stop));
    diag.set("last_step_m", best.result.last_step_m);
    diag.set("energy", best.result.energy);
    diag.set("observations", static_cast<double>(frame_.data.observations.size()));
    diag.set("residual_px", best.fit.residual_px);
    diag.set("far_share", best.fit.far_share);
    diag.set("coherence", best.fit.coherence);
    diag.set("far_around", best.fit.far_around);
    diag.set("crease", best.fit.crease);
    diag.set("strain", best.fit.strain);
    diag.set("start", static_cast<double>(best.guess));
    diag.set("starts_tried", static_cast<double>(tried_));
    diag.set("starts_cut", starts_cut_ ? 1.0 : 0.0);
    diag.set("inconsistent_known_points", frame_.inconsistent_pairs);
  }

  solvers::GuessSearch guesses_;
  bool previous_only_ = false;
  bool wants_covariance_ = true;
  double scale_noise_ = 0.004;

  MeshModel mesh_;
  std::uint64_t mesh_revision_ = 0;
  Frame frame_;
  ShapeSearch search_;
  FitGauge gauge_;
  ShapeCovariance covariance_;
  std::array<Candidate, 6> candidates_;
  std::size_t tried_ = 0;
  int best_ = -1;
  std::optional<Budget> budget_;
  bool starts_cut_ = false;  ///< by the budget of the frame
};

}  // namespace
}  // namespace weft::gauss_newton

using weft::gauss_newton::GaussNewton;
using weft::gauss_newton::OutlinePose;
WEFT_LIBRARY(
    WEFT_COMPONENT(
        GaussNewton, "solvers/gauss_newton", "1.1.0",
        "Fits a shape to matches by robust least squares that preserves lengths on the surface."),
    WEFT_COMPONENT(OutlinePose, "solvers/outline_pose", "1.0.0",
                   "Lays the template at rest into the mask of the object, as an initial guess."))
