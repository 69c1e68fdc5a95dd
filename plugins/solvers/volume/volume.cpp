// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/solver.hpp>

#include "covariance.hpp"
#include "frame.hpp"
#include "search.hpp"
#include "solid_model.hpp"

namespace weft::volume {
namespace {

// A shape that is further from what was seen is lost.
constexpr double kLostResidual_px = 6.0;

/// Elastic bodies: matches on the visible side against the deformation of a lattice of tetrahedra.
class Volume final : public Solver {
 public:
  static constexpr About kAbout{
      .reference =
          "own: Parashar et al., As-rigid-as-possible volumetric Shape-from-Template, ICCV (2015); "
          "Smith et al., Analytic eigensystems for isotropic distortion energies, ACM TOG 38 "
          "(2019)",
      .needs = "correspondences",
      .reads = "previous.shape known_points object_mask"};

  explicit Volume(Params& p) {
    search_.scales.trust = {3.0, true};
    search_.scales.outline.reach_px = 12.0;  // a body's rim runs close to its other edges
    p.choice("method", search_.method,
             {{"newton", Method::newton}, {"position_based", Method::position_based}},
             "newton: minimum of the elastic energy; position_based: position-based dynamics with "
             "constant edge lengths and volumes, cheaper and less exact");
    p.read("poisson_ratio", poisson_ratio_, "", {0.0, 0.495},
           "Poisson's ratio of the material: 0 for cork, 0.3 for a sponge, 0.49 for an organ");
    p.read("strain", search_.scales.strain, "", {1e-4, 10.0},
           "standard deviation of the strain of a part of the body, a sixth of the diagonal wide");
    p.read("mean_strain", search_.scales.mean_strain, "", {1e-4, 10.0},
           "standard deviation of the strain, averaged over the thickness of the body");
    p.read("unevenness", search_.scales.unevenness, "", {1e-4, 10.0},
           "standard deviation of the nodes from an even bend or twist of a part, relative to half "
           "of the thickness");
    p.read("match_noise_px", frame_.options.match_noise_px, "px", {1e-3, 100.0},
           "standard deviation, along u and v, of a match without a covariance");
    p.read("covariance_noise_px", frame_.options.covariance_noise_px, "px", {0.0, 100.0},
           "standard deviation that is added to the covariance of a match");
    p.read("outlier", search_.scales.trust.scale, "", {0.1, 1e6},
           "residual, in standard deviations, at which the robust loss reduces the weight to 1/4");
    p.read("known_radius_m", frame_.options.known_radius_m, "m", {0.0, 1.0},
           "radius of known points whose own radius is negative; 0: exact positions");
    p.read("min_matches", frame_.options.min_matches, "", {6, 1000000},
           "minimum number of matches for a result");
    p.read("max_iterations", search_.options.max_iterations, "", {1, 1000000},
           "maximum number of Newton iterations per initial guess");
    p.read("tolerance_m", search_.options.tolerance_m, "m", {0.0, 1.0},
           "root mean square step of the nodes at which the iteration stops");
    p.read("scale_noise", noise_.scale, "", {0.0, 1.0},
           "relative standard deviation of the template's size and of the focal length, for the "
           "covariance");
    solvers::OutlineScales& outline = search_.scales.outline;
    p.read("outline_noise_px", outline.noise_px, "px", {1e-2, 100.0},
           "standard deviation of a point of the mask's outline, across the outline");
    p.read("outline_outlier_px", outline.outlier_px, "px", {0.1, 1000.0},
           "distance between the rim of the shape and the outline from which on it has no "
           "influence");
    p.read("outline_weight", outline.share, "", {0.0, 1000.0},
           "factor on the weight of the outline; 0: no such term");
    p.read("covariance", wants_covariance_, "covariance of each vertex in the result");
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (auto ready = prepare_body(in.templ); !ready) return ready.error();
    if (auto read = frame_.read(in, body_); !read) return read.error();
    const std::optional<Candidate> best = search_.run(in, frame_);
    if (!best) return no_result("lost: fewer than 12 matches agree on a pose of the object");
    if (!(best->fit.residual_px < kLostResidual_px)) {
      return no_result("lost: the median point is " + std::to_string(best->fit.residual_px) +
                       " px from where it was seen");
    }
    return shape_of(in, *best);
  }

 private:
  Result<void> prepare_body(const Template& templ) {
    if (revision_ != 0 && templ.revision == revision_) return {};
    revision_ = 0;
    search_.scales.material = Material::of_poisson_ratio(poisson_ratio_);
    if (auto built = body_.build(templ); !built) return built;
    if (auto ready = search_.prepare(body_); !ready) return ready;
    revision_ = templ.revision;
    return {};
  }

  Result<Shape> shape_of(const SolverInput& in, const Candidate& best) {
    Shape shape;
    const Points3 surface_m = body_.surface_of(best.nodes_m);
    shape.vertices_m = make_array<double>(surface_m);
    shape.nodes_m = make_array<double>(best.nodes_m);
    shape.source = Array<std::uint8_t>({surface_m.rows()});
    std::copy(frame_.observed.begin(), frame_.observed.end(), shape.source.data());
    const ShapeEvidence evidence =
        shape_evidence(in.templ, in.camera, shape.vertices_m, in.correspondences, in.sightlines);
    const Array<double> spread =
        covariance_m2(body_, search_.energy(), frame_.data, search_.scales, best.fit, in.camera,
                      noise_, best.nodes_m, search_.newton());
    shape.confidence =
        confidence(best.fit, spread, evidence) * confidence_of_filters(in.correspondences);
    if (wants_covariance_) shape.covariance_m2 = spread;
    explain(best, shape.diag);
    return shape;
  }

  /// The probability that the mean error of the observed vertices is below 2 % of the diagonal, for
  /// a Maxwell distribution with their mean variance. It is multiplied by the square root of the
  /// share of the matches that agree.
  double confidence(const Fit& fit, const Array<double>& covariance_m2,
                    const ShapeEvidence& evidence) const {
    if (!covariance_m2.present() || evidence.kept == 0) return 0.0;
    double variance_m2 = 0.0, count = 0.0;
    for (std::int64_t v = 0; v < covariance_m2.rows(); ++v) {
      if (frame_.observed[to_index(v)] == 0) continue;
      const double* block = covariance_m2.row(v);
      variance_m2 += (block[0] + block[4] + block[8]) / 3.0;
      count += 1.0;
    }
    if (count == 0.0) return 0.0;
    constexpr double kGood = 0.02, kMaxwell = 0.7978845608028654;  // sqrt(2 / pi)
    const double x = kGood * body_.diagonal_m() / std::sqrt(variance_m2 / count);
    const double within = std::erf(x / std::sqrt(2.0)) - kMaxwell * x * std::exp(-0.5 * x * x);
    const double agreeing = static_cast<double>(evidence.agreeing) / evidence.kept;
    const double fits = logistic(2.0 * (3.0 - fit.residual_px));
    return std::clamp(within, 0.0, 1.0) * std::sqrt(agreeing) * fits;
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
    diag.set("deformation", best.fit.deformation);
    if (frame_.data.outline.present()) {
      diag.set("outline_points", static_cast<double>(search_.energy().outline().points().size()));
      diag.set("outline_met", search_.energy().outline().met_share());
    }
    diag.set("start", static_cast<double>(best.guess));
    diag.set("starts_tried", search_.tried());
  }

  double poisson_ratio_ = 0.45;
  ScaleNoise noise_;
  bool wants_covariance_ = true;

  SolidModel body_;
  std::uint64_t revision_ = 0;
  Frame frame_;
  BodySearch search_;
};

}  // namespace
}  // namespace weft::volume

using weft::volume::Volume;
WEFT_PLUGIN(Volume, "solvers/volume", "1.0.0",
            "Fits an elastic body of tetrahedra to matches on its visible side.")
