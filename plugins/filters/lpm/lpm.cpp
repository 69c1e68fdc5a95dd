// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "common/candidates.hpp"
#include "common/nearest.hpp"

namespace {

using weft::FilterInput;
using weft::InlierMask;
using weft::Points2;
using weft::filters::Nearest;

constexpr std::size_t kScales = 3;  // sizes of a neighbourhood
constexpr int kScaleStep = 2;       // between them

/// Keeps the matches whose nearest neighbours are the same in both images and move alike.
class Lpm final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{
      .reference =
          "paper: Ma, Zhao, Jiang, Zhou and Guo 2019, IJCV 127 (Locality preserving matching)",
      .needs = "template camera"};
  static constexpr weft::Sweep kSweep{"lambda", {0.05, 0.2, 0.4, 0.6, 0.7, 0.8, 1, 1.2, 1.5}};

  explicit Lpm(weft::Params& p) {
    p.read("neighbours", neighbours_, "", {3, 100},
           "number K of neighbours; costs are means over the K - 2, K and K + 2 nearest");
    p.read(
        "first_lambda", first_lambda_, "", {0, 2},
        "maximum first-pass cost of the matches that form the neighbourhoods of the second pass");
    p.read("lambda", lambda_, "", {0, 2}, "maximum cost of a kept match");
    p.read("tau", tau_, "", {-1, 1},
           "minimum agreement of two motions: ratio of the smaller to the larger length, times the "
           "cosine of their angle");
  }

  weft::Result<InlierMask> filter(const FilterInput& in) override {
    const auto candidates = weft::filters::candidates_of(in.correspondences);
    if (!candidates) return candidates.error();
    const std::size_t n = candidates->count();
    const auto least = weft::to_index(neighbours_ + kScaleStep + 1);
    if (n < least) {
      return weft::no_result("too few matches for neighbourhoods: " + std::to_string(n) + " of " +
                             std::to_string(least));
    }
    const auto sizes = weft::filters::sizes_of(in);
    if (!sizes) return sizes.error();
    const Points2 p = candidates->template_px / sizes->template_px.norm();
    const Points2 q = candidates->image_px / sizes->image_px.norm();
    std::vector<int> among(n);
    std::iota(among.begin(), among.end(), 0);
    std::vector<double> cost = costs(p, q, among);
    std::erase_if(among, [&](int i) { return cost[weft::to_index(i)] > first_lambda_; });
    const std::size_t first_kept = among.size();
    const bool again = first_kept >= least;
    if (again) cost = costs(p, q, among);
    std::vector<std::uint8_t> keep;
    std::vector<double> score;
    for (const double each : cost) {
      keep.push_back(each <= lambda_ ? 1 : 0);
      score.push_back(1.0 - 0.5 * each);
    }
    InlierMask mask = weft::filters::mask_of(in.correspondences, *candidates, keep, score);
    mask.diag.set("first_pass_matches", static_cast<double>(first_kept));
    if (!again) {
      return weft::degenerate(std::move(mask),
                              "only " + std::to_string(first_kept) + " matches have neighbours");
    }
    return mask;
  }

 private:
  /// Costs of each match, 0 where neighbours and motions agree, 2 where neither does.
  std::vector<double> costs(const Points2& p, const Points2& q,
                            const std::vector<int>& among) const {
    const int most = neighbours_ + kScaleStep;
    const Nearest in_template = weft::filters::nearest_of(p, among, most);
    const Nearest in_image = weft::filters::nearest_of(q, among, most);
    const Points2 motion = q - p;
    std::vector<double> cost;
    std::vector<Rank> rank_in_image(weft::to_index(p.rows()));
    for (Eigen::Index i = 0; i < p.rows(); ++i) {
      weft::worked(5 * most);
      for (int k = 0; k < most; ++k) {
        const int j = in_image(i, k);
        if (j >= 0) rank_in_image[weft::to_index(j)] = {i, k};
      }
      cost.push_back(cost_of(i, in_template, rank_in_image, motion));
    }
    return cost;
  }

  /// Where a match stands among the neighbours of another; out of date for any but that.
  struct Rank {
    Eigen::Index of = -1;
    int rank = 0;
  };

  double cost_of(Eigen::Index i, const Nearest& in_template, const std::vector<Rank>& rank_in_image,
                 const Points2& motion) const {
    std::array<int, kScales> alike{}, common{};  // per size
    for (int k = 0; k < in_template.cols(); ++k) {
      const int j = in_template(i, k);
      if (j < 0 || rank_in_image[weft::to_index(j)].of != i) continue;
      const int farther = std::max(k, rank_in_image[weft::to_index(j)].rank);
      const bool agrees = likeness(motion.row(i), motion.row(j)) >= tau_;
      for (std::size_t s = 0; s < kScales; ++s) {
        const int shared = farther < size_of(s) ? 1 : 0;
        common[s] += shared;
        alike[s] += agrees ? shared : 0;
      }
    }
    double sum = 0.0;
    for (std::size_t s = 0; s < kScales; ++s) {
      // A neighbour that is not shared costs 1, and so does one that moves differently.
      const int size = size_of(s), lost = size - common[s], unlike = common[s] - alike[s];
      sum += static_cast<double>(lost + unlike) / size;
    }
    return sum / kScales;
  }

  int size_of(std::size_t scale) const {
    return neighbours_ + kScaleStep * (static_cast<int>(scale) - 1);
  }

  /// The smaller length over the larger, times the cosine of the angle between.
  static double likeness(const Eigen::RowVector2d& a, const Eigen::RowVector2d& b) {
    const double largest2 = std::max(a.squaredNorm(), b.squaredNorm());
    return largest2 > 0.0 ? a.dot(b) / largest2 : 1.0;
  }

  int neighbours_ = 6;
  double first_lambda_ = 0.8;
  double lambda_ = 0.5;
  double tau_ = 0.2;
};

}  // namespace

WEFT_PLUGIN(Lpm, "filters/lpm", "1.0.0",
            "Rejects matches whose nearest neighbours differ or move differently.")
