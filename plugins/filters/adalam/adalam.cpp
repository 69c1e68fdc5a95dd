// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "common/candidates.hpp"
#include "local_map.hpp"

namespace {

using weft::Correspondences;
using weft::FilterInput;
using weft::InlierMask;
using weft::adalam::Agreement;
using weft::filters::Candidates;

/// Candidates with the evidence of their descriptors, if they have any.
struct Evidence {
  std::vector<std::size_t> rank;  ///< [n] 0 for the candidate whose ratio is best
  std::vector<double> angle_rad;  ///< [n] image minus template, or empty
  std::vector<double> log_scale;  ///< [n] of image scale / template scale, or empty
};

/// Keeps the matches that agree with one of many local affine maps.
class AdaLam final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{
      .reference = "paper: Cavalli, Larsson, Oswald, Sattler and Pollefeys 2020, ECCV (AdaLAM)",
      .needs = "template camera",
      .random = true};
  static constexpr weft::Sweep kSweep{"min_confidence", {2, 5, 10, 20, 50, 100, 200, 500, 3000}};

  explicit AdaLam(weft::Params& p) {
    p.read("min_confidence", settings_.min_confidence, "", {1e-3, 1e6},
           "minimum ratio of agreeing matches to those expected by chance");
    p.read("area_ratio", area_ratio_, "", {1, 1e5},
           "image area divided by the area of a disc whose radius separates the seeds");
    p.read("search_expansion", search_expansion_, "", {1, 100},
           "radius of a neighbourhood, in seed radii (see area_ratio)");
    p.read("most_draws", settings_.most_draws, "", {1, 100'000},
           "maximum number of maps tried per seed");
    p.read("min_inliers", min_inliers_, "", {2, 1000},
           "minimum number of matches that agree with a seed");
    p.read("most_turn_rad", most_turn_rad_, "rad", {0, 4},
           "maximum difference between the keypoint rotations of neighbours; ignored if angles are "
           "unknown");
    p.read("most_scale_ratio", most_scale_ratio_, "", {1, 1000},
           "maximum ratio of the keypoint scale changes of neighbours");
    p.read("most_stretch", settings_.most_stretch, "", {1, 1000},
           "maximum factor by which a map stretches or shrinks");
  }

  weft::Result<InlierMask> filter(const FilterInput& in) override {
    const auto sizes = weft::filters::sizes_of(in);
    if (!sizes) return sizes.error();
    const auto candidates = weft::filters::candidates_of(in.correspondences);
    if (!candidates) return candidates.error();
    const std::size_t n = candidates->count();
    if (n <= weft::to_index(min_inliers_)) {
      return weft::no_result("too few matches for neighbourhoods: " + std::to_string(n) + " of " +
                             std::to_string(min_inliers_ + 1));
    }
    const Evidence evidence = evidence_of(in, *candidates);
    const double part = 1.0 / (area_ratio_ * std::numbers::pi);
    template_radius_px_ = std::sqrt(sizes->template_px.prod() * part);
    image_radius_px_ = std::sqrt(sizes->image_px.prod() * part);
    std::vector<std::uint8_t> keep(n, 0);
    std::vector<double> confidence(n, 0.0);
    const std::vector<std::size_t> seeds = seeds_of(*candidates, evidence);
    std::size_t accepted = 0;
    for (const std::size_t seed : seeds) {
      if (in.call.cancelled()) return weft::Error{weft::Errc::cancelled, "cancelled"};
      accepted += grow(*candidates, evidence, seed, keep, confidence) ? 1 : 0;
    }
    for (double& each : confidence) each /= each + settings_.min_confidence;
    InlierMask mask = weft::filters::mask_of(in.correspondences, *candidates, keep, confidence);
    mask.diag.set("seeds", static_cast<double>(seeds.size()));
    mask.diag.set("accepted_seeds", static_cast<double>(accepted));
    if (accepted == 0) {
      return weft::degenerate(std::move(mask), "around no seed enough matches agree");
    }
    return mask;
  }

 private:
  /// Ranks by ratio; a random order where the ratios are equal or unknown.
  static Evidence evidence_of(const FilterInput& in, const Candidates& candidates) {
    const Correspondences& matches = in.correspondences;
    const std::size_t n = candidates.count();
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    weft::Rng rng = in.call.rng();
    rng.shuffle(order);
    if (matches.ratio.present()) {
      std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return matches.ratio(candidates.matches[a]) < matches.ratio(candidates.matches[b]);
      });
    }
    Evidence evidence;
    evidence.rank.resize(n);
    for (std::size_t k = 0; k < n; ++k) evidence.rank[order[k]] = k;
    for (const std::int64_t match : candidates.matches) {
      if (matches.angle_difference_rad.present()) {
        evidence.angle_rad.push_back(matches.angle_difference_rad(match));
      }
      if (matches.scale_ratio.present()) {
        evidence.log_scale.push_back(std::log(matches.scale_ratio(match)));
      }
    }
    return evidence;
  }

  /// The candidates that are best within a radius around them, the best first.
  std::vector<std::size_t> seeds_of(const Candidates& candidates, const Evidence& evidence) const {
    const weft::Points2& p = candidates.template_px;
    const double radius2_px2 = template_radius_px_ * template_radius_px_;
    std::vector<std::uint8_t> beaten(candidates.count(), 0);
    // Candidates are sorted by u: those within the radius stand close.
    for (Eigen::Index i = 0; i < p.rows(); ++i) {
      weft::worked(10);
      for (Eigen::Index j = i + 1; j < p.rows() && p(j, 0) - p(i, 0) < template_radius_px_; ++j) {
        weft::worked_in_loop(j);
        if ((p.row(i) - p.row(j)).squaredNorm() >= radius2_px2) continue;
        const auto a = weft::to_index(i), b = weft::to_index(j);
        beaten[evidence.rank[a] < evidence.rank[b] ? b : a] = 1;
      }
    }
    std::vector<std::size_t> seeds;
    for (std::size_t k = 0; k < beaten.size(); ++k) {
      if (beaten[k] == 0) seeds.push_back(k);
    }
    return seeds;
  }

  /// The candidates around a seed that turn and are scaled as it is, the most trusted first.
  std::vector<std::size_t> members_of(const Candidates& candidates, const Evidence& evidence,
                                      std::size_t seed) const {
    const auto at = static_cast<Eigen::Index>(seed);
    const double template_px = search_expansion_ * template_radius_px_;
    const double image_px = search_expansion_ * image_radius_px_;
    std::vector<std::size_t> members;
    weft::worked(static_cast<std::int64_t>(candidates.count()));
    for (std::size_t k = 0; k < candidates.count(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      if (k == seed ||
          (candidates.template_px.row(row) - candidates.template_px.row(at)).squaredNorm() >=
              template_px * template_px ||
          (candidates.image_px.row(row) - candidates.image_px.row(at)).squaredNorm() >=
              image_px * image_px ||
          !looks_alike(evidence, seed, k)) {
        continue;
      }
      members.push_back(k);
    }
    std::sort(members.begin(), members.end(),
              [&](std::size_t a, std::size_t b) { return evidence.rank[a] < evidence.rank[b]; });
    return members;
  }

  bool looks_alike(const Evidence& evidence, std::size_t seed, std::size_t k) const {
    if (!evidence.angle_rad.empty()) {
      const double turn_rad =
          std::remainder(evidence.angle_rad[k] - evidence.angle_rad[seed], 2.0 * std::numbers::pi);
      if (std::abs(turn_rad) > most_turn_rad_) return false;
    }
    return evidence.log_scale.empty() ||
           std::abs(evidence.log_scale[k] - evidence.log_scale[seed]) <=
               std::log(most_scale_ratio_);
  }

  /// Marks the matches around a seed that agree with one map; false where too few do.
  bool grow(const Candidates& candidates, const Evidence& evidence, std::size_t seed,
            std::vector<std::uint8_t>& keep, std::vector<double>& confidence) const {
    const std::vector<std::size_t> members = members_of(candidates, evidence, seed);
    if (members.size() < weft::to_index(min_inliers_)) return false;
    weft::adalam::Neighbourhood around;
    const auto at = static_cast<Eigen::Index>(seed);
    for (const std::size_t member : members) {
      const auto k = static_cast<Eigen::Index>(member);
      const Eigen::RowVector2d from =
          candidates.template_px.row(k) - candidates.template_px.row(at);
      const Eigen::RowVector2d to = candidates.image_px.row(k) - candidates.image_px.row(at);
      around.in_template.emplace_back(from.transpose() / (search_expansion_ * template_radius_px_));
      around.in_image.emplace_back(to.transpose() / (search_expansion_ * image_radius_px_));
    }
    const Agreement agreement = weft::adalam::agreement_of(around, settings_);
    const auto agreeing = static_cast<double>(agreement.agreeing);
    if (agreement.agreeing == 0 || agreeing * (1.0 - 1.0 / agreement.sureness) < min_inliers_) {
      return false;
    }
    const auto mark = [&](std::size_t k, double sureness) {
      confidence[k] = std::max(confidence[k], sureness);
      if (sureness >= settings_.min_confidence) keep[k] = 1;
    };
    mark(seed, agreement.sureness);
    for (std::size_t k = 0; k < members.size(); ++k) mark(members[k], agreement.confidence[k]);
    return true;
  }

  weft::adalam::Settings settings_;
  double area_ratio_ = 100.0;
  double search_expansion_ = 4.0;
  int min_inliers_ = 6;
  double most_turn_rad_ = std::numbers::pi / 6.0;
  double most_scale_ratio_ = 1.5;
  double template_radius_px_ = 0.0, image_radius_px_ = 0.0;
};

}  // namespace

WEFT_PLUGIN(AdaLam, "filters/adalam", "1.0.0",
            "Rejects matches that do not agree with a local affine map around a trusted match.")
