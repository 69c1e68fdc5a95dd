// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "affine_seeds.hpp"
#include "displacement_spline.hpp"
#include "matches.hpp"

namespace weft::aem {

/// Where matches are expected before any of them is looked at.
struct Start {
  Points2 image_px;                     ///< [n,2] of the matches' template points
  std::vector<Eigen::Matrix2d> slopes;  ///< [n] of the map there, or one for all
  double scale = 1.0;                   ///< [] image px per template px
  double sigma_px = 1.0;                ///< how far off it may be

  const Eigen::Matrix2d& slope(Eigen::Index i) const {
    return slopes[slopes.size() == 1 ? 0 : static_cast<std::size_t>(i)];
  }
};

Start start_from(const Matches& matches, const Seed& seed);

/// A coherent set of matches and the warp that it follows.
struct Solution {
  Points2 control_px;           ///< of the displacement from the start
  Points2 residual_px;          ///< [n,2] warp less image point
  Eigen::ArrayXd logit;         ///< [n] log odds that a match is correct
  double sigma_px = 0.0;        ///< of the residuals of correct matches along each axis
  double share = 0.0;           ///< [] of correct matches
  double log_likelihood = 0.0;  ///< less the warp's bending
  int rounds = 0;
};

struct AnnealingOptions {
  int control_long = 8, control_short = 6;  ///< control points along the template's sides
  double margin_px = 20.0;                  ///< of the spline's domain around the template
  double stiffness = 8.0;                   ///< kappa, weight of the bending
  double least_sigma_px = 1.0;
};

/// Expectation maximisation for the mixture of a warp with normal residuals and mismatches spread
/// evenly over the image, from a coarse start to a fine warp: the stiffness lambda = kappa sigma^2
/// / s^2 falls as sigma does.
class Annealing {
 public:
  Annealing(const Matches& matches, const AnnealingOptions& options);

  /// From a warp of which some places [V,2] px in template and image are known.
  Start start_along(const Points2& flat_px, const Points2& image_px);
  Solution run(const Start& start);
  /// Improves it with all matches near the warp; in its log odds the warp then counts as uncertain
  /// where few matches determine it.
  void finish(const Start& start, Solution& solution);

 private:
  struct State;
  State state_of(const Start& start) const;
  void gather(const Start& start, State& state, Eigen::Index most);
  void measure(State& state) const;
  void improve(const Start& start, State& state);
  Solution conclude(const Start& start, const State& state) const;
  Eigen::Vector2d residual_px(const State& state, Eigen::Index i) const;
  double bias(const Start& start, Eigen::Index i) const;
  double logit_constant(double sigma_px, double share) const;

  const Matches& matches_;
  AnnealingOptions options_;
  DisplacementSpline spline_;
  std::vector<DisplacementSpline::Site> sites_;
};

}  // namespace weft::aem
