// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <weft/sdk/filter.hpp>

#include "neighbour_sets.hpp"
#include "steps.hpp"

namespace weft::myneighbor {

enum class Mode { paper, authors_code };
enum class Transfer { mesh, warp };
enum class Refinement { off, irls };

struct Options {
  Mode mode = Mode::paper;
  double alpha_s = 0.15;          ///< [] of the mean distance of warped vertices; paper
  double authors_alpha_s = 0.07;  ///< [] of the mean distance of image points; authors_code
  double mf_threshold_scale = 1.0;
  int min_selected = 8;
  int steps = 3;   ///< [] the last one judges
  int passes = 1;  ///< [] of steps I and II
  Transfer transfer = Transfer::mesh;
  bool weighted_fit = false;
  Refinement refinement = Refinement::off;
  std::vector<double> irls_scales_px{20, 12, 8, 5, 4, 3, 3, 3};
  double irls_keep_px = 4.0;
};

/// How far a match came.
enum class Stage : std::uint8_t {
  candidate,  ///< takes part
  selected,   ///< its neighbours are mostly the same (step I)
  trusted,    ///< and it agrees with the warp of those (step II)
};

/// Steps I and II of the method, with the refinement: finds the warp that most matches with similar
/// neighbourhoods agree on, and the distance of each match to it.
class Consensus {
 public:
  Consensus(const Options& options, const WarpComponent& warp) : options_(options), warp_(warp) {}

  Result<void> run(const FilterInput& in);

  const std::vector<std::int64_t>& candidates() const { return candidates_; }  ///< [m] matches
  const std::vector<double>& mismatch_percent() const { return mismatch_; }    ///< [m]
  const std::vector<double>& distance_px() const { return distance_px_; }      ///< [m]
  Stage stage(std::size_t k) const;                                            ///< for candidate k
  const Selection& selection() const { return selection_; }
  const Trim& trim() const { return trim_; }
  const Points2& vertices_px() const { return vertices_px_; }  ///< [V,2] the warped mesh
  /// Mean distance of the warped vertices; in authors_code of the image points of step II.
  double object_size_px() const;
  /// The reason if a fit was degenerate, else empty.
  const std::string& flag() const { return flag_; }

 private:
  using Marks = std::vector<std::uint8_t>;

  Result<void> collect(const FilterInput& in);
  Result<void> run_steps(const FilterInput& in, const Marks& active);
  Marks near_the_warp() const;
  Result<void> select_by_neighbours(const Marks& active);
  Result<void> refit_robustly(const FilterInput& in);
  Result<void> fit(const FilterInput& in, const Marks& used, const std::vector<double>* weights);
  Result<void> measure(const FilterInput& in, Transfer transfer);
  std::vector<double> neighbour_weights() const;

  const Options& options_;
  const WarpComponent& warp_;
  std::vector<std::int64_t> candidates_;
  Points2 template_px_, image_px_;  // points of the candidates
  std::vector<double> mismatch_, distance_px_;
  Selection selection_;  // selection among the candidates
  Trim trim_;
  NeighbourSets in_template_, in_image_;
  Array<std::uint8_t> used_;  // [N], of all matches
  Weights weights_;
  Warp fitted_;
  Points2 vertices_px_;
  std::string flag_;
};

}  // namespace weft::myneighbor
