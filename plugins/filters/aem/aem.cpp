// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <utility>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>

#include "common/candidates.hpp"
#include "search.hpp"

namespace {

using weft::FilterInput;
using weft::InlierMask;
using weft::ShapeState;
using weft::aem::Found;
using weft::aem::Track;

constexpr std::size_t kFewestMatches = 3;

/// Where the last shape, if there was one, has the template's vertices in the image.
std::optional<Track> track_of(const FilterInput& in) {
  if (!in.previous_shape || !in.camera) return {};
  const ShapeState state = in.previous_shape->shape_state();
  if (state == ShapeState::none || state == ShapeState::lost) return {};
  const weft::Camera& camera = *in.camera;
  Track track{in.templ->flat_px.matrix<2>(),
              weft::project_points({camera.fx, camera.fy, camera.cx, camera.cy},
                                   in.previous_shape->vertices_m.matrix<3>())};
  if (track.flat_px.rows() != track.image_px.rows() || !track.image_px.allFinite()) return {};
  return track;
}

double probability(double logit) { return 1.0 / (1.0 + std::exp(-logit)); }

/// Keeps the matches of the most likely coherent set.
class Aem final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{
      .reference = "own: affine seeds and annealed expectation maximisation of a spline warp",
      .needs = "template",
      .reads = "camera previous.shape",
      .random = true};
  static constexpr weft::Sweep kSweep{
      "min_probability", {1e-30, 1e-6, 0.01, 0.5, 0.99, 0.9999, 0.99999, 0.999999, 0.9999999}};

  explicit Aem(weft::Params& p) {
    weft::aem::AnnealingOptions& annealing = options_.annealing;
    p.read("min_probability", min_probability_, "", {0, 1},
           "minimum inlier probability of a kept match");
    p.read("most_draws", options_.most_draws, "", {1, 1'000'000},
           "maximum number of samples of three matches; reached only if few matches are inliers");
    p.read("use_orientation", use_orientation_,
           "use of the scales and angles of the keypoints, if the matches have them");
    p.read("track", track_, "additional search near the previous shape");
    p.read("control_long", annealing.control_long, "", {4, 16},
           "number of control points along the longer side of the template");
    p.read("control_short", annealing.control_short, "", {4, 16},
           "number of control points along the shorter side of the template");
    p.read("fine_control_long", annealing.fine_control_long, "", {4, 16},
           "number of control points along the longer side in the final, deciding rounds");
    p.read("fine_control_short", annealing.fine_control_short, "", {4, 16},
           "number of control points along the shorter side in the final, deciding rounds");
    p.read("margin_px", annealing.margin_px, "px of the texture", {0, 1e4},
           "width of the border that the warp's domain adds to the object's box in the texture");
    p.read("stiffness", annealing.stiffness, "", {1e-3, 1e6},
           "weight of the warp's bending energy; 1.5 follows outliers, 50 does not follow the "
           "surface");
    p.read("least_sigma_px", annealing.least_sigma_px, "px", {0.01, 100},
           "minimum standard deviation of inliers along each axis");
    p.read("sure_confidence", options_.sure, "", {0, 1},
           "confidence below which the result is marked as degenerate");
    p.read("least_confidence", least_confidence_, "", {0, 1}, "minimum confidence of a result");
  }

  weft::Result<InlierMask> filter(const FilterInput& in) override {
    const auto candidates = weft::filters::candidates_of(in.correspondences);
    if (!candidates) return candidates.error();
    if (candidates->count() < kFewestMatches) {
      return weft::no_result(
          "too few matches for an affine map: " + std::to_string(candidates->count()) + " of 3");
    }
    const weft::aem::Matches matches =
        weft::aem::matches_of(in.correspondences, *candidates, *in.templ, use_orientation_);
    if (!(matches.image_area_px2 > 0.0)) {
      return weft::no_result("the matches lie on a line or in one place of the image");
    }
    weft::Rng rng = in.call.rng();
    const auto found = weft::aem::find_object(
        matches, track_ ? track_of(in) : std::optional<Track>{}, options_, rng);
    if (!found) return weft::no_result("no coherent set: no three matches show a surface");
    if (found->confidence < least_confidence_) {
      return weft::no_result("no coherent set to be trusted: confidence " +
                             percent(found->confidence));
    }
    return answer(in, *candidates, *found);
  }

 private:
  static std::string percent(double part) {
    return std::to_string(std::lround(100.0 * part)) + " %";
  }

  weft::Result<InlierMask> answer(const FilterInput& in,
                                  const weft::filters::Candidates& candidates,
                                  const Found& found) const {
    std::vector<std::uint8_t> keep;
    std::vector<double> score;
    double kept = 0.0;
    for (const double logit : found.solution.logit) {
      score.push_back(probability(logit));
      keep.push_back(score.back() >= min_probability_ ? 1 : 0);
      kept += keep.back();
    }
    if (kept == 0.0) {
      return weft::no_result("none of " + std::to_string(candidates.count()) +
                             " matches has the probability min_probability");
    }
    InlierMask mask = weft::filters::mask_of(in.correspondences, candidates, keep, score);
    mask.confidence = weft::make_scalar(found.confidence);
    mask.diag.set("kept_matches", kept);
    mask.diag.set("confidence", found.confidence);
    mask.diag.set("log_likelihood", found.solution.log_likelihood);
    mask.diag.set("rival", found.rival);
    mask.diag.set("tracked", found.tracked ? 1.0 : 0.0);
    mask.diag.set("sigma_px", found.solution.sigma_px);
    mask.diag.set("share", found.solution.share);
    mask.diag.set("scale", found.scale);
    mask.diag.set("rounds", found.solution.rounds);
    mask.diag.set("draws", found.draws);
    if (found.confidence < options_.sure) {
      const std::string why = found.rival > weft::aem::kHarmlessRival
                                  ? "another set of matches is as likely"
                                  : "few matches agree";
      return weft::degenerate(std::move(mask), why + ": confidence " + percent(found.confidence));
    }
    return mask;
  }

  weft::aem::SearchOptions options_;
  double min_probability_ = 0.5;
  double least_confidence_ = 0.25;
  bool use_orientation_ = true;
  bool track_ = true;
};

}  // namespace

WEFT_PLUGIN(Aem, "filters/aem", "1.3.0",
            "Keeps the most likely coherent set of matches and gives its confidence.")
