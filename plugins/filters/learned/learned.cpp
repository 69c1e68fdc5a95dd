// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>

#include "common/candidates.hpp"
#include "network.hpp"

namespace {

using weft::FilterInput;
using weft::InlierMask;
using weft::filters::Candidates;
using weft::learned::MatchSet;

constexpr std::size_t kFewestMatches = 4;
constexpr double kTrainedTolerancePx = 3.0;

/// Values of the candidates; empty where the matches lack them or one is not finite.
template <class Convert>
std::vector<double> values_of(const weft::Array<double>& column, const Candidates& candidates,
                              Convert&& convert) {
  std::vector<double> values;
  if (!column.present()) return values;
  for (const std::int64_t match : candidates.matches) {
    values.push_back(convert(column(match)));
    if (!std::isfinite(values.back())) return {};
  }
  return values;
}

/// Keeps the matches that a network regards as inliers.
class Learned final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{
      .reference =
          "own: after Moo Yi, Trulls, Ono, Lepetit, Salzmann and Fua 2018, CVPR (context "
          "normalisation), and Sun, Jiang, Trulls, Tagliasacchi and Moo Yi 2020, CVPR (attentive "
          "context normalisation)",
      .needs = "template camera"};
  static constexpr weft::Sweep kSweep{"threshold",
                                      {1e-5, 1e-3, 0.01, 0.1, 0.5, 0.9, 0.99, 0.999, 0.9999}};

  explicit Learned(weft::Params& p) {
    p.read("threshold", threshold_, "", {0, 1}, "probability above which a match is kept");
    p.read("tolerance_px", tolerance_px_, "px", {0.01, 1000},
           "distance from its true image point below which a match counts as an inlier");
    p.input_path("weights", weights_path_,
                 "weights of the network (npz); default: the built-in ones");
  }

  weft::Result<void> prepare(const weft::PrepareInput& /*in*/) override { return load(); }

  weft::Result<InlierMask> filter(const FilterInput& in) override {
    const auto candidates = weft::filters::candidates_of(in.correspondences);
    if (!candidates) return candidates.error();
    const auto sizes = weft::filters::sizes_of(in);
    if (!sizes) return sizes.error();
    const std::size_t n = candidates->count();
    if (n < kFewestMatches) {
      return weft::no_result("too few matches for a network: " + std::to_string(n) + " of " +
                             std::to_string(kFewestMatches));
    }
    if (const auto loaded = load(); !loaded) return loaded.error();
    const MatchSet matches =
        set_of(in.correspondences, *candidates, 0.5 * sizes->template_px.norm());
    const Eigen::VectorXf logits = weft::learned::logits_of(*weights_, matches);
    std::vector<std::uint8_t> keep;
    std::vector<double> score;
    for (const float logit : logits) {
      score.push_back(1.0 / (1.0 + std::exp(-static_cast<double>(logit))));
      keep.push_back(score.back() > threshold_ ? 1 : 0);
    }
    InlierMask mask = weft::filters::mask_of(in.correspondences, *candidates, keep, score);
    if (std::find(keep.begin(), keep.end(), 1) == keep.end()) {
      return weft::degenerate(std::move(mask), "no match is probably an inlier");
    }
    return mask;
  }

 private:
  /// Reads the weights once; a filter inside another component is not prepared.
  weft::Result<void> load() {
    if (weights_) return {};
    auto weights = weights_path_.empty() ? weft::learned::built_in_weights()
                                         : weft::learned::read_weights(weights_path_);
    if (!weights) return weights.error();
    weights_ = *std::move(weights);
    return {};
  }

  MatchSet set_of(const weft::Correspondences& matches, const Candidates& candidates,
                  double half_diagonal_px) const {
    const double per_px = kTrainedTolerancePx / tolerance_px_;
    MatchSet set;
    set.template_px = candidates.template_px;
    set.image_px = candidates.image_px * per_px;
    set.log_scale = values_of(matches.scale_ratio, candidates,
                              [&](double ratio) { return std::log(ratio * per_px); });
    const auto as_is = [](double value) { return value; };
    set.angle_rad = values_of(matches.angle_difference_rad, candidates, as_is);
    set.ratio = values_of(matches.ratio, candidates, as_is);
    set.half_diagonal_px = half_diagonal_px;
    return set;
  }

  double threshold_ = 0.5;
  double tolerance_px_ = kTrainedTolerancePx;
  std::string weights_path_;
  std::optional<weft::learned::Weights> weights_;
};

}  // namespace

WEFT_PLUGIN(Learned, "filters/learned", "1.0.0",
            "Keeps the matches that a trained network regards as inliers.")
