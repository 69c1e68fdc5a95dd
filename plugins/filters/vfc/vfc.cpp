// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "common/candidates.hpp"
#include "common/preset/preset.hpp"
#include "motion_field.hpp"

namespace {

using weft::FilterInput;
using weft::InlierMask;
using weft::Points2;

constexpr std::size_t kFewestMatches = 4;
constexpr double kFewCorrect = 0.2;  // share below which the field may be that of nothing

/// Subtracts the mean and divides by the root mean square norm; all zero stays so.
Points2 normalised(const Points2& points) {
  Points2 result = points.rowwise() - points.colwise().mean();
  const double norm = std::sqrt(result.rowwise().squaredNorm().mean());
  if (norm > 0.0) result /= norm;
  return result;
}

/// Keeps the matches that follow a smooth field of motions.
class Vfc final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{
      .reference =
          "paper: Ma, Zhao, Tian, Yuille and Tu 2014, IEEE TIP 23(4) (Vector field consensus)",
      .random = true};
  static constexpr weft::Sweep kSweep{"theta",
                                      {1e-6, 1e-5, 0.0001, 0.001, 0.03, 0.5, 0.9, 0.99, 0.999}};

  explicit Vfc(weft::Params& p) {
    if (weft::declare_preset(p) == weft::Preset::weft) centres_ = 50;
    p.prominent().read("theta", settings_.theta, "", {0, 1},
                       "inlier probability above which a match is kept");
    p.read("beta", settings_.beta, "", {1e-6, 1e3},
           "rate of the kernels exp(-beta |x - y|^2); larger values let the field vary more");
    p.read("lambda", settings_.lambda, "", {0, 1e6}, "weight of the field's smoothness");
    p.read("first_gamma", settings_.first_gamma, "", {0.01, 0.99}, "initial share of inliers");
    p.read("mismatch_area", settings_.mismatch_area, "", {1e-3, 1e6},
           "area over which outliers are spread, in normalised coordinates");
    p.read("centres", centres_, "", {3, 1000}, "number of kernels, at matches drawn at random");
    p.read("most_rounds", settings_.most_rounds, "", {1, 100'000},
           "maximum number of rounds of expectation and fit");
  }

  weft::Result<InlierMask> filter(const FilterInput& in) override {
    const auto candidates = weft::filters::candidates_of(in.correspondences);
    if (!candidates) return candidates.error();
    const std::size_t n = candidates->count();
    if (n < kFewestMatches) {
      return weft::no_result("too few matches for a field: " + std::to_string(n) + " of " +
                             std::to_string(kFewestMatches));
    }
    const Points2 places = normalised(candidates->template_px);
    const Points2 motions = normalised(candidates->image_px) - places;
    weft::Rng rng = in.call.rng();
    const auto verdict = weft::vfc::follow(places, motions, drawn(places, rng), settings_);
    std::vector<std::uint8_t> keep;
    std::vector<double> score;
    for (const double probability : verdict.probability) {
      keep.push_back(probability > settings_.theta ? 1 : 0);
      score.push_back(probability);
    }
    InlierMask mask = weft::filters::mask_of(in.correspondences, *candidates, keep, score);
    const auto kept = std::count(keep.begin(), keep.end(), std::uint8_t{1});
    mask.diag.set("gamma", verdict.gamma);
    mask.diag.set("sigma", verdict.sigma);
    mask.diag.set("rounds", verdict.rounds);
    if (static_cast<double>(kept) < kFewCorrect * static_cast<double>(n)) {
      return weft::degenerate(std::move(mask), "fewer than a fifth of the matches follow a field");
    }
    return mask;
  }

 private:
  /// Some of the places, all where they are few (Fisher-Yates).
  Points2 drawn(const Points2& places, weft::Rng& rng) const {
    const auto n = static_cast<std::uint32_t>(places.rows());
    const std::uint32_t count = std::min(n, static_cast<std::uint32_t>(centres_));
    std::vector<std::uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0U);
    Points2 chosen(count, 2);
    for (std::uint32_t k = 0; k < count; ++k) {
      std::swap(order[k], order[k + rng.below(n - k)]);
      chosen.row(k) = places.row(order[k]);
    }
    return chosen;
  }

  weft::vfc::Settings settings_;
  int centres_ = 16;
};

}  // namespace

WEFT_PLUGIN(Vfc, "filters/vfc", "2.0.0",
            "Rejects matches that do not follow a smooth motion field.")
