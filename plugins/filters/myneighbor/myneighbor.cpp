// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <weft/data/matrix.hpp>

#include "consensus.hpp"

namespace {

using namespace weft::myneighbor;
using weft::FilterInput;
using weft::InlierMask;

constexpr double kFoldedShare = 0.2;      // share of the faces, above which the warp is suspicious
constexpr double kSmallestObject = 0.02;  // share of the image's diagonal

/// Keeps the matches that agree with a warp fitted to those whose Delaunay neighbours in template
/// and image are mostly the same (Shetab-Bushehri et al. 2023, Section V).
class MyNeighbor final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{
      .reference = "paper: Shetab-Bushehri et al. 2023, ROBUSfT, Section V",
      .needs = "template",
      .reads = "camera"};
  static constexpr weft::Sweep kSweep{"alpha_s", {0.005, 0.02, 0.04, 0.08, 0.15, 0.2, 0.3, 0.5, 1}};

  explicit MyNeighbor(weft::Params& p) {
    Options& o = options_;
    p.choice(
        "mode", o.mode, {{"paper", Mode::paper}, {"authors_code", Mode::authors_code}},
        "variant of the method; paper: as published; authors_code: as in the authors' program");
    p.read("steps", o.steps, "", {1, 3},
           "step that decides; 1: matches selected by step I; 2: matches left by step II; 3: "
           "matches that agree with the warp of step II");
    p.read("passes", o.passes, "", {1, 10},
           "number of passes of steps I and II; later passes exclude clear outliers");
    p.prominent().read(
        "alpha_s", o.alpha_s, "", {0, 10},
        "maximum residual of a kept match, relative to the mean distance of the warped "
        "vertices; for paper");
    p.read("authors_alpha_s", o.authors_alpha_s, "", {0, 10},
           "maximum residual of a kept match, relative to the mean distance of the points of step "
           "II; for authors_code");
    p.read("mf_threshold_scale", o.mf_threshold_scale, "", {0, 10},
           "mismatch factor below which step I selects a match, relative to the mean factor");
    p.read("min_selected", o.min_selected, "", {8, 100000},
           "number of selected matches below which step I takes the smallest factors instead, a "
           "fifth but at least 8");
    p.choice(
        "transfer", o.transfer, {{"mesh", Transfer::mesh}, {"warp", Transfer::warp}},
        "mapping of template points to the image; mesh: the warped mesh; warp: the warp itself");
    p.read("weighted_fit", o.weighted_fit,
           "weights of the fit that decrease with the mismatch factor");
    p.choice("refinement", o.refinement, {{"off", Refinement::off}, {"irls", Refinement::irls}},
             "refinement of the warp; off: none; irls: robust refits to all matches");
    p.read("irls_scales_px", o.irls_scales_px, "px", {0.01, 1e4},
           "scales s of the robust refits, one each, with weights (s^2 / (s^2 + r^2))^2; for irls");
    p.read("irls_keep_px", o.irls_keep_px, "px", {0, 1e4},
           "maximum residual of a kept match, instead of alpha_s; for irls");
    p.component("warp", warp_, "warp that is fitted to the matches");
  }

  weft::Result<InlierMask> filter(const FilterInput& in) override {
    if (auto done = consensus_.run(in); !done) return done.error();
    const double size_px = consensus_.object_size_px();
    if (!(size_px > 0.0)) return weft::no_result("the warp shrinks the template to a point");
    const double folded = folded_share(consensus_.vertices_px(), in.templ->faces.matrix<3>());
    const double threshold_px = this->threshold_px(size_px);
    InlierMask mask = judge(in, threshold_px);
    add_scalars(mask, size_px, threshold_px, folded);
    const std::string flag = reason(in, size_px, folded);
    if (!flag.empty()) return weft::degenerate(std::move(mask), flag);
    return mask;
  }

 private:
  double threshold_px(double size_px) const {
    if (options_.refinement == Refinement::irls) return options_.irls_keep_px;
    return size_px * (options_.mode == Mode::paper ? options_.alpha_s : options_.authors_alpha_s);
  }

  /// True if candidate k is kept, and its score, which is above 1/2 for candidates that step III
  /// keeps. Where step I decides, the score is 1 less the mismatch factor.
  std::pair<bool, double> verdict(std::size_t k, double threshold_px) const {
    const Stage stage = consensus_.stage(k);
    const double mismatch_percent = consensus_.mismatch_percent()[k];
    const double distance_px = consensus_.distance_px()[k];
    const double score = threshold_px > 0.0 ? threshold_px / (threshold_px + distance_px) : 0.0;
    if (options_.steps == 1) {
      const bool took_part = !std::isnan(mismatch_percent);
      return {stage != Stage::candidate, took_part ? 1.0 - 0.01 * mismatch_percent : 0.0};
    }
    if (options_.steps == 2) return {stage == Stage::trusted, score};
    return {distance_px < threshold_px, score};
  }

  InlierMask judge(const FilterInput& in, double threshold_px) const {
    const std::int64_t n = in.correspondences.count();
    const Eigen::VectorXd none =
        Eigen::VectorXd::Constant(n, std::numeric_limits<double>::quiet_NaN());
    InlierMask mask;
    mask.kept = weft::Array<std::uint8_t>({n}, 0);
    mask.score = weft::Array<double>({n}, 0.0);
    weft::Array<double> factor = weft::make_array<double>(none);
    weft::Array<double> distance = weft::make_array<double>(none);
    weft::Array<double> stage = weft::make_array<double>(none);
    for (std::size_t k = 0; k < consensus_.candidates().size(); ++k) {
      const std::int64_t i = consensus_.candidates()[k];
      const auto [kept, score] = verdict(k, threshold_px);
      mask.kept(i) = kept ? 1 : 0;
      mask.score(i) = score;
      factor(i) = consensus_.mismatch_percent()[k];
      distance(i) = consensus_.distance_px()[k];
      stage(i) = static_cast<double>(consensus_.stage(k));
    }
    mask.diag.set("mismatch_factor_percent", factor);
    mask.diag.set("distance_px", distance);
    mask.diag.set("stage", stage);
    return mask;
  }

  void add_scalars(InlierMask& mask, double size_px, double threshold_px, double folded) const {
    const Selection& selection = consensus_.selection();
    const Trim& trim = consensus_.trim();
    std::int64_t kept = 0;
    for (std::int64_t i = 0; i < mask.kept.rows(); ++i) kept += mask.kept(i);
    mask.diag.set("candidates", static_cast<double>(consensus_.candidates().size()));
    mask.diag.set("mf_mean_percent", selection.mean_percent);
    mask.diag.set("mf_threshold_percent", selection.threshold_percent);
    mask.diag.set("step1_matches", static_cast<double>(selection.count));
    mask.diag.set("step1_fallback", selection.fallback ? 1.0 : 0.0);
    mask.diag.set("step2_median_px", trim.median_px);
    mask.diag.set("step2_mad_px", trim.mad_px);
    mask.diag.set("step2_matches", static_cast<double>(trim.count));
    mask.diag.set("l_s_px", size_px);
    mask.diag.set("threshold_px", threshold_px);
    mask.diag.set("kept_matches", static_cast<double>(kept));
    mask.diag.set("folded_share", folded);
    mask.diag.set("warp_suspicious", folded > kFoldedShare ? 1.0 : 0.0);
  }

  /// Why the answer is to be used with care; empty when there is no reason.
  std::string reason(const FilterInput& in, double size_px, double folded) const {
    if (folded > kFoldedShare) return "the warp folds more than a fifth of the mesh";
    if (in.camera) {
      const double diagonal_px = std::hypot(static_cast<double>(in.camera->width_px),
                                            static_cast<double>(in.camera->height_px));
      if (size_px < kSmallestObject * diagonal_px) return "the object is tiny in the image";
    }
    return consensus_.flag();
  }

  Options options_;
  weft::WarpComponent warp_{"warps/bbs"};
  Consensus consensus_{options_, warp_};
};

}  // namespace

WEFT_PLUGIN(MyNeighbor, "filters/myneighbor", "1.0.0",
            "Rejects matches whose neighbours differ between template and image.")
