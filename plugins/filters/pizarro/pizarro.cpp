// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>
#include <weft/core/index.hpp>

#include "common/candidates.hpp"
#include "local_smoothness.hpp"
#include "shrinking_warp.hpp"

namespace {

using weft::FilterInput;
using weft::InlierMask;
using weft::Points2;
using weft::filters::Candidates;
using weft::pizarro::Verdict;

constexpr std::size_t kFewestMatches = 4;
constexpr int kOcclusionRounds = 2;

/// Keeps the matches that their neighbours predict, on the part of the surface that does not hide
/// behind another.
class Pizarro final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{
      .reference = "reconstruction: Pizarro and Bartoli 2012, IJCV 97(1)",
      .needs = "template camera"};
  static constexpr weft::Sweep kSweep{"theta", {0.02, 0.1, 0.2, 0.3, 0.5, 0.7, 1, 2.5, 5}};

  explicit Pizarro(weft::Params& p) {
    p.read("theta", settings_.theta, "", {1e-3, 100},
           "prediction error below which a match is kept, relative to the spread of its neighbours "
           "in the image");
    p.read("neighbours", settings_.neighbours, "", {5, 100},
           "number of nearest matches on the template that predict a match");
    p.read("triples", settings_.triples, "", {1, 100'000}, "number of affine maps tried per match");
    p.read("rounds", settings_.rounds, "", {0, 100},
           "maximum number of rounds that remove the worst matches");
    p.read("self_occlusion", self_occlusion_,
           "rejection of matches on self-occluded parts, found by a warp that shrinks there");
  }

  weft::Result<InlierMask> filter(const FilterInput& in) override {
    const auto sizes = weft::filters::sizes_of(in);
    if (!sizes) return sizes.error();
    const auto candidates = weft::filters::candidates_of(in.correspondences);
    if (!candidates) return candidates.error();
    const std::size_t n = candidates->count();
    if (n < kFewestMatches) {
      return weft::no_result("too few matches for neighbourhoods: " + std::to_string(n) + " of " +
                             std::to_string(kFewestMatches));
    }
    Verdict verdict =
        weft::pizarro::locally_smooth(candidates->template_px, candidates->image_px, settings_);
    if (std::count(verdict.keep.begin(), verdict.keep.end(), std::uint8_t{1}) == 0) {
      return weft::no_result("no match agrees with its neighbours");
    }
    const bool few = n < weft::to_index(weft::pizarro::kFewestLocal);
    const double hidden_share =
        self_occlusion_ && !few ? reject_hidden(*candidates, sizes->template_px, verdict) : 0.0;
    std::vector<double> score;
    for (std::size_t k = 0; k < n; ++k) {
      const double residual = verdict.residual[k];
      score.push_back(std::isnan(residual) ? 0.0 : settings_.theta / (settings_.theta + residual));
    }
    InlierMask mask = weft::filters::mask_of(in.correspondences, *candidates, verdict.keep, score);
    mask.diag.set("rounds", verdict.rounds);
    mask.diag.set("hidden_share", hidden_share);
    if (few) {
      return weft::degenerate(std::move(mask),
                              "too few matches for neighbourhoods: one affine map "
                              "judges them");
    }
    return mask;
  }

 private:
  /// Rejects kept matches on the hidden part; that of the last warp is returned as a share.
  static double reject_hidden(const Candidates& candidates, const Eigen::RowVector2d& texture_px,
                              Verdict& verdict) {
    double share = 0.0;
    for (int round = 0; round < kOcclusionRounds; ++round) {
      std::vector<Eigen::Index> kept;
      for (std::size_t k = 0; k < verdict.keep.size(); ++k) {
        if (verdict.keep[k] != 0) kept.push_back(static_cast<Eigen::Index>(k));
      }
      if (kept.size() < kFewestMatches) break;
      const Points2 p = candidates.template_px(kept, Eigen::all);
      const Points2 q = candidates.image_px(kept, Eigen::all);
      const auto map = weft::pizarro::hidden_by_itself(p, q, texture_px);
      if (!map) break;
      share = map->share();
      bool changed = false;
      for (const Eigen::Index k : kept) {
        if (!map->at(candidates.template_px(k, 0), candidates.template_px(k, 1))) continue;
        verdict.keep[weft::to_index(k)] = 0;
        changed = true;
      }
      if (!changed) break;
    }
    return share;
  }

  weft::pizarro::Settings settings_;
  bool self_occlusion_ = true;
};

}  // namespace

WEFT_PLUGIN(Pizarro, "filters/pizarro", "1.1.0",
            "Rejects matches that violate local smoothness or lie on self-occluded parts.")
