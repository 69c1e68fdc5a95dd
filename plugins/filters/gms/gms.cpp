// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "cell_support.hpp"
#include "common/candidates.hpp"
#include "common/preset/preset.hpp"

namespace {

using weft::FilterInput;
using weft::InlierMask;
using weft::Points2;
using weft::gms::Layout;

constexpr std::array kScales{1.0, 0.5, 0.70710678118654752, 1.4142135623730951, 2.0};
constexpr int kTurns = 8;
constexpr int kFewestCells = 3;
constexpr int kFewestChosen = 8;  // in half as many, mismatches alone find support

/// The support of each match under the best of the rotations and scales.
struct Support {
  std::vector<double> of_match;
  std::int64_t kept = -1;
  int turn = 0;
  double scale = 1.0;
};

/// Keeps the matches that many others go along with, from neighbouring cells to neighbouring cells.
class Gms final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{
      .reference = "paper: Bian, Lin, Matsushita, Yeung, Nguyen and Cheng 2017, CVPR (GMS)",
      .needs = "template camera"};
  static constexpr weft::Sweep kSweep{"alpha", {0.5, 1, 2, 3, 4, 6, 8, 10, 15}};

  explicit Gms(weft::Params& p) {
    if (weft::declare_preset(p) == weft::Preset::weft) {
      matches_per_cell_ = 12.0;
      least_matches_ = 300;
    }
    p.read("alpha", alpha_, "", {0, 1000},
           "support above which a match is kept: consistent matches divided by the square root of "
           "the mean number of matches per cell");
    p.read("cells", most_cells_, "", {kFewestCells, 100},
           "maximum number of cells along each side of the texture");
    p.read("matches_per_cell", matches_per_cell_, "", {0, 1000},
           "mean number of matches per cell below which the grid is made coarser; 0: fixed grid");
    p.read("rotations", rotations_, "search over eight rotations in the image plane");
    p.read("scales", scales_, "search over image cells of half to twice the size");
    p.read("least_matches", least_matches_, "", {1, 1'000'000},
           "minimum number of matches for a result");
  }

  weft::Result<InlierMask> filter(const FilterInput& in) override {
    const auto sizes = weft::filters::sizes_of(in);
    if (!sizes) return sizes.error();
    const auto candidates = weft::filters::candidates_of(in.correspondences);
    if (!candidates) return candidates.error();
    if (candidates->count() < weft::to_index(least_matches_)) {
      return weft::no_result(
          "too few matches for statistics of cells: " + std::to_string(candidates->count()) +
          " of " + std::to_string(least_matches_));
    }
    // Pixel centres are integers: the images begin at -0.5.
    const Points2 p = (candidates->template_px.array() + 0.5).matrix() *
                      sizes->template_px.cwiseInverse().asDiagonal();
    const Points2 q =
        (candidates->image_px.array() + 0.5).matrix() * sizes->image_px.cwiseInverse().asDiagonal();
    const int cells = cells_for(candidates->count());
    const Support best = best_support(p, q, cells);
    std::vector<std::uint8_t> keep;
    std::vector<double> score;
    for (const double support : best.of_match) {
      keep.push_back(support > alpha_ ? 1 : 0);
      score.push_back(support > 0.0 ? support / (support + alpha_) : 0.0);
    }
    InlierMask mask = weft::filters::mask_of(in.correspondences, *candidates, keep, score);
    mask.diag.set("cells", cells);
    mask.diag.set("turn_deg", 360.0 / kTurns * best.turn);
    mask.diag.set("cell_scale", best.scale);
    if (best.kept == 0) return weft::degenerate(std::move(mask), "no cell has enough support");
    return mask;
  }

 private:
  /// The statistic uses the matches in a cell: a grid for many is too fine for few.
  int cells_for(std::size_t matches) const {
    if (matches_per_cell_ == 0.0) return most_cells_;
    const double side = std::sqrt(static_cast<double>(matches) / matches_per_cell_);
    return std::min(std::max(static_cast<int>(side), kFewestChosen), most_cells_);
  }

  Support best_support(const Points2& p, const Points2& q, int cells) const {
    Support best;
    for (const double scale : kScales) {
      for (int turn = 0; turn < kTurns; ++turn) {
        if ((!scales_ && scale != 1.0) || (!rotations_ && turn != 0)) continue;
        Support tried{shifted_support(p, q, cells, scale, turn), 0, turn, scale};
        tried.kept = std::count_if(tried.of_match.begin(), tried.of_match.end(),
                                   [&](double support) { return support > alpha_; });
        if (tried.kept > best.kept) best = std::move(tried);
      }
    }
    return best;
  }

  /// The largest of four grids, so that no match is judged at the border of its cell alone.
  static std::vector<double> shifted_support(const Points2& p, const Points2& q, int cells,
                                             double scale, int turn) {
    std::vector<double> largest(weft::to_index(p.rows()), 0.0);
    const int image_cells = std::max(kFewestCells, static_cast<int>(std::lround(cells * scale)));
    for (const bool shifted_u : {false, true}) {
      for (const bool shifted_v : {false, true}) {
        weft::worked(20 * p.rows());
        const std::vector<double> support =
            weft::gms::support_of(p, q, Layout{cells, image_cells, turn, shifted_u, shifted_v});
        for (std::size_t i = 0; i < largest.size(); ++i) {
          largest[i] = std::max(largest[i], support[i]);
        }
      }
    }
    return largest;
  }

  double alpha_ = 6.0;
  int most_cells_ = 20;
  double matches_per_cell_ = 0.0;
  bool rotations_ = true;
  bool scales_ = true;
  int least_matches_ = 2;
};

}  // namespace

WEFT_PLUGIN(Gms, "filters/gms", "2.0.0",
            "Rejects matches with few consistent matches in neighbouring cells.")
