// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/shape_evidence.hpp>
#include <weft/sdk/solver.hpp>

#include "common/seen/hidden_faces.hpp"
#include "common/seen/image_line.hpp"
#include "integrated_fit.hpp"
#include "matches.hpp"
#include "mesh_model.hpp"

namespace weft::collins_integrated {
namespace {

/// Where a fit began; the numbers are those of diag.start.
enum class Start { previous = 0, component = 1 };

constexpr double kLostResidual_px = 6.0, kDoubtfulResidual_px = 3.0;
constexpr double kUsualStrain = 0.03, kDoubtfulStrain = 0.02;
constexpr int kFewestSamples = 30;
constexpr int kSureMatches = 30, kSureSamples = 100;

/// A shape that a start led to.
struct Candidate {
  Start start = Start::previous;
  Points3 vertices_m = Points3(0, 3);
  std::vector<std::uint8_t> observed;  ///< [V] 1 for vertices that something seen holds
  Fit fit;
  bool shown_by_matches = false, shown_by_texture = false;

  bool usable() const { return shown_by_matches || shown_by_texture; }
  int rank() const { return usable() ? fit.support() : -1; }
};

/// Matches and texture in one energy, from the previous shape.
class CollinsIntegrated final : public Solver {
 public:
  static constexpr About kAbout{.reference =
                                    "reconstruction: Collins, Bartoli, Realtime "
                                    "Shape-from-Template: System and Applications, "
                                    "ISMAR (2015)",
                                .needs = "image",
                                .reads = "correspondences visibility previous.shape"};

  explicit CollinsIntegrated(Params& p) : fit_(read_options(p)) {
    p.read("match_noise_px", match_noise_px_, "px", {1e-3, 100.0},
           "standard deviation of a match without a covariance");
    p.read("min_matches", min_matches_, "", {4, 1000000},
           "minimum number of matches for a new initialization of the object");
    p.read("lost_zncc", lost_zncc_, "", {0.0, 1.0},
           "median normalised cross-correlation above which the texture confirms a shape");
    p.formerly("start").component("initial_guess", start_,
                                  "solver that initializes the object again after a loss");
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (auto fits = check_image(in); !fits) return fits.error();
    if (auto ready = prepare_mesh(in); !ready) return ready.error();
    if (auto read = read_frame(in); !read) return read.error();
    fit_.load(*in.image);
    std::optional<Candidate> best;
    if (is_start(in.previous_shape)) {
      frame_.previous_m = in.previous_shape->vertices_m.matrix<3>();
      best = fitted(Start::previous, frame_.previous_m);
    }
    if (!best || is_doubtful(*best)) {
      if (has_matches()) {
        auto started = start_.solve(in);
        if (!started && started.error().code != Errc::no_result) return started.error();
        frame_.previous_m.resize(0, 3);
        if (started && is_start(*started)) {
          Candidate other = fitted(Start::component, started->vertices_m.matrix<3>());
          if (!best || other.rank() > best->rank()) best = std::move(other);
        }
      }
      if (!best || !best->usable()) return no_result(why_lost(best));
    }
    return build_shape(in, *best);
  }

  bool joins_seams() const override { return false; }  // works in the plane of the texture

 private:
  static FitOptions read_options(Params& p) {
    FitOptions options;
    options.scales.previous_m = 0.05;
    p.read("samples", options.samples, "", {16, 20000},
           "approximate number of samples of the texture");
    p.read("levels", options.levels, "", {1, 5},
           "number of image pyramid levels, each half as large as the previous one");
    p.read("rounds", options.rounds, "", {1, 20},
           "number of searches for the samples per pyramid level");
    p.read("reach_px", options.reach_px, "px of the level", {1, LineSearch::kMostReach},
           "search distance of a sample");
    p.read("min_zncc", options.min_zncc, "", {0.0, 1.0},
           "minimum normalised cross-correlation of a sample that counts");
    p.read("texture_noise_px", options.texture_noise_px, "px of the level", {1e-3, 100.0},
           "standard deviation of a sample along its normal");
    p.read("outlier", options.outlier, "", {1.0, 1e6},
           "residual, in standard deviations, beyond which a measurement has no weight");
    p.read("strain", options.scales.strain, "", {1e-5, 1.0},
           "standard deviation of the relative edge-length error");
    p.read("bend_rad", options.scales.bend_rad, "rad", {1e-3, 100.0},
           "standard deviation of the bend of a mesh square, relative to its bend at rest");
    p.read(
        "previous_m", options.scales.previous_m, "m", {0.0, 100.0},
        "standard deviation of the distance of a vertex from the previous shape; 0: no such term");
    p.read("max_iterations", options.max_iterations, "", {1, 1000},
           "maximum number of iterations per round");
    return options;
  }

  static Result<void> check_image(const SolverInput& in) {
    if (!in.image) return Error{Errc::invalid_data, "needs 'image'"};
    const Array<std::uint8_t>& pixels = in.image->pixels;
    const bool fits = pixels.size() > 0 && pixels.dim(0) == in.camera.height_px &&
                      pixels.dim(1) == in.camera.width_px &&
                      (pixels.ndim() == 2 || pixels.dim(2) == 1 || pixels.dim(2) == 3);
    if (fits) return {};
    return Error{Errc::invalid_data,
                 "the image must have the size of the camera and one or three channels"};
  }

  /// Once for a template and a camera.
  Result<void> prepare_mesh(const SolverInput& in) {
    const Template& templ = in.templ;
    const std::array<std::uint64_t, 3> key{templ.revision,
                                           static_cast<std::uint64_t>(in.camera.width_px),
                                           static_cast<std::uint64_t>(in.camera.height_px)};
    if (templ.revision != 0 && key == prepared_) return {};
    prepared_ = {};  // until all is made
    const bool has_texture =
        templ.texture.size() > 0 && std::min(templ.texture.dim(0), templ.texture.dim(1)) >= 2 &&
        templ.mask.dim(0) == templ.texture.dim(0) && templ.mask.dim(1) == templ.texture.dim(1);
    if (!has_texture) {
      return Error{Errc::invalid_data,
                   "the template needs a texture of 2 px and more along each side, and a mask of "
                   "its size"};
    }
    if (auto built = mesh_.build(templ); !built) return built;
    if (auto ready = fit_.prepare(templ, in.camera, mesh_); !ready) return ready;
    prepared_ = key;
    return {};
  }

  Result<void> read_frame(const SolverInput& in) {
    frame_.camera = {in.camera.fx, in.camera.fy, in.camera.cx, in.camera.cy};
    frame_.matches.clear();
    frame_.texture.clear();
    frame_.previous_m.resize(0, 3);
    frame_.hidden_faces.clear();
    if (in.visibility) {
      if (auto read = solvers::read_hidden_faces(*in.visibility, mesh_.faces, mesh_.vertex_count(),
                                                 frame_.hidden_faces);
          !read)
        return read;
    }
    if (!in.correspondences) return {};
    return read_matches(*in.correspondences, mesh_, match_noise_px_, frame_.hidden_faces,
                        frame_.matches);
  }

  bool is_start(const std::optional<Shape>& shape) const {
    if (!shape) return false;
    const ShapeState state = shape->shape_state();
    if (state == ShapeState::none || state == ShapeState::lost) return false;
    const auto vertices_m = shape->vertices_m.matrix<3>();
    return vertices_m.rows() == mesh_.vertex_count() && vertices_m.allFinite() &&
           vertices_m.col(2).minCoeff() > 0.0;
  }

  /// True if there are enough matches for a shape without a previous one.
  bool has_matches() const {
    return frame_.matches.size() >= to_index(min_matches_) && !matches_lie_on_a_line();
  }

  bool matches_lie_on_a_line() const {
    return solvers::lie_on_a_line(frame_.matches,
                                  [](const Observation& seen) { return seen.seen_px; });
  }

  Candidate fitted(Start start, const Points3& start_m) {
    Candidate candidate;
    candidate.start = start;
    run(true, start_m, candidate);
    if (!candidate.shown_by_texture) run(false, start_m, candidate);
    return candidate;
  }

  void run(bool with_texture, const Points3& start_m, Candidate& candidate) {
    candidate.vertices_m = start_m;
    candidate.fit = fit_.run(with_texture, frame_, candidate.vertices_m);
    candidate.observed = fit_.observed();
    const Fit& fit = candidate.fit;
    const bool is_surface = candidate.vertices_m.allFinite() &&
                            candidate.vertices_m.col(2).minCoeff() > 0.0 &&
                            std::isfinite(fit.energy);
    candidate.shown_by_matches = is_surface && has_matches() && fit.agreeing >= min_matches_ &&
                                 fit.residual_px < kLostResidual_px;
    candidate.shown_by_texture = is_surface && with_texture && fit.found >= kFewestSamples &&
                                 fit.in_sight >= kFewestSamples && fit.median_zncc > lost_zncc_;
  }

  bool is_doubtful(const Candidate& candidate) const {
    if (has_matches() && !candidate.shown_by_matches) return true;
    const Fit& fit = candidate.fit;
    return !candidate.shown_by_texture || fit.residual_px > kDoubtfulResidual_px ||
           fit.strain > kDoubtfulStrain || fit.folds > 0 || !fit.looks_right();
  }

  std::string why_lost(const std::optional<Candidate>& tried) const {
    std::string why = "lost: " + std::to_string(frame_.matches.size()) + " matches on the mesh";
    if (frame_.matches.size() < to_index(min_matches_)) {
      why += " of at least " + std::to_string(min_matches_);
    } else if (matches_lie_on_a_line()) {
      why += ", all on a line of the image or in one place";
    }
    if (!tried) return why + ", and no previous shape to follow";
    return why + ", and " + std::to_string(tried->fit.agreeing) +
           " of them agree with a shape; the texture correlates by " +
           std::to_string(tried->fit.median_zncc) + " with the image";
  }

  Result<Shape> build_shape(const SolverInput& in, const Candidate& best) const {
    Shape shape;
    shape.vertices_m = make_array<double>(best.vertices_m);
    shape.source = Array<std::uint8_t>({mesh_.vertex_count()});
    std::copy(best.observed.begin(), best.observed.end(), shape.source.data());
    const ShapeEvidence evidence =
        shape_evidence(in.templ, in.camera, best.vertices_m, in.correspondences, {});
    shape.confidence = confidence(best, evidence) * confidence_of_filters(in.correspondences);
    explain(best, shape.diag);
    const std::string doubt = doubt_in(in, best);
    if (doubt.empty()) return shape;
    shape.state = static_cast<std::int32_t>(ShapeState::weak);
    return degenerate(std::move(shape), doubt);
  }

  /// Not calibrated: the product of the evidence of lengths, matches and texture, so that each
  /// alone can lower it.
  static double confidence(const Candidate& best, const ShapeEvidence& evidence) {
    const double by_count =
        std::max(static_cast<double>(evidence.agreeing) / kSureMatches,
                 best.shown_by_texture ? static_cast<double>(best.fit.found) / kSureSamples : 0.0);
    const double by_strain = logistic(-2.0 * std::log((best.fit.strain + 1e-3) / kUsualStrain));
    const double share =
        static_cast<double>(best.fit.alike) / std::max(1.0, static_cast<double>(best.fit.in_sight));
    const double by_look =
        best.shown_by_texture ? share * logistic(12.0 * (best.fit.median_zncc - 0.6)) : 0.5;
    return std::min(1.0, by_count) * by_strain * by_look;
  }

  std::string doubt_in(const SolverInput& in, const Candidate& best) const {
    const std::string zncc = std::to_string(best.fit.median_zncc);
    if (!best.shown_by_texture) {
      return "weak: by the matches alone, the texture correlates by " + zncc + " with the image";
    }
    if (!in.correspondences || best.shown_by_matches) return {};
    if (!has_matches()) {
      return "weak: by the texture alone, there are " + std::to_string(frame_.matches.size()) +
             " matches on the mesh";
    }
    return "weak: the texture shows a shape from which the median match is " +
           std::to_string(best.fit.residual_px) + " px off";
  }

  void explain(const Candidate& best, Diagnostics& diag) const {
    diag.set("start", static_cast<double>(best.start));
    diag.set("matches", static_cast<double>(frame_.matches.size()));
    diag.set("residual_px", best.fit.residual_px);
    diag.set("median_zncc", best.fit.median_zncc);
    diag.set("samples_in_sight", best.fit.in_sight);
    diag.set("samples_turned", best.fit.turned);
    diag.set("samples_alike", best.fit.alike);
    diag.set("samples_found", best.fit.found);
    diag.set("folds", best.fit.folds);
    diag.set("strain", best.fit.strain);
    diag.set("iterations", best.fit.iterations);
    diag.set("energy", best.fit.energy);
  }

  double match_noise_px_ = 1.0;
  double lost_zncc_ = 0.5;
  int min_matches_ = 15;
  SolverComponent start_{"solvers/ngo_laplacian"};

  IntegratedFit fit_;
  MeshModel mesh_;
  std::array<std::uint64_t, 3> prepared_{};  ///< revision and size of the image that all is for
  FrameData frame_;
};

}  // namespace
}  // namespace weft::collins_integrated

using weft::collins_integrated::CollinsIntegrated;
WEFT_PLUGIN(
    CollinsIntegrated, "solvers/collins_integrated", "1.0.0",
    "Tracks a shape by matches, texture, lengths, bends and the previous shape in one energy.")
