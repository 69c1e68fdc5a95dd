// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/core/index.hpp>

#include "affine_seeds.hpp"
#include "displacement_spline.hpp"
#include "isolated.hpp"
#include "matches.hpp"

namespace weft::aem {

/// Where matches are expected before any of them is looked at.
struct Start {
  Points2 image_px;                     ///< [n,2] of the matches' template points
  std::vector<Eigen::Matrix2d> slopes;  ///< [n] of the map there, or one for all
  double scale = 1.0;                   ///< [] image px per template px
  double sigma_px = 1.0;                ///< how far off it may be

  const Eigen::Matrix2d& slope(Eigen::Index i) const {
    return slopes[slopes.size() == 1 ? 0 : to_index(i)];
  }
};

Start start_from(const Matches& matches, const Seed& seed);

/// A coherent set of matches: those that follow one warp.
struct Solution {
  Points2 residual_px;          ///< [n,2] warp less image point
  Eigen::ArrayXd bias;          ///< [n] what scale and angle add to the log odds
  Eigen::ArrayXd logit;         ///< [n] log odds that a match is correct
  double sigma_px = 0.0;        ///< standard deviation of the residuals of inliers along each axis
  double share = 0.0;           ///< [] share of inliers
  double log_likelihood = 0.0;  ///< log-likelihood of the coarse warp, less its bending
  int rounds = 0;

  Eigen::Index correct() const { return (logit > 0.0).count(); }
};

struct AnnealingOptions {
  int control_long = 8, control_short = 6;  ///< control points along the template's sides
  int fine_control_long = 12, fine_control_short = 9;  ///< the same for the last look
  double margin_px = 20.0;      ///< margin of the spline's domain around the template
  double stiffness = 8.0;       ///< kappa, weight of the bending
  double fine_stiffness = 3.0;  ///< the same for the last look: what bends little is found already
  double least_sigma_px = 1.0;
  Eigen::Index most_annealed = 128, most_finished = 512;  ///< matches that take part
  int last_rounds = 3;
};

/// Expectation maximisation for a mixture: a warp with normal residuals, and mismatches spread
/// evenly over the image. It proceeds from a coarse to a fine warp: the stiffness lambda = kappa
/// sigma^2 / s^2 falls as sigma does.
class Annealing {
 public:
  Annealing(const Matches& matches, const AnnealingOptions& options);

  /// The start from a warp with some known places [V,2] px in template and image.
  Start start_along(const Points2& flat_px, const Points2& image_px);
  Solution run(const Start& start);
  /// A last look at all matches near the warp, which may bend more; in the log odds it then counts
  /// as uncertain where few matches determine it.
  void finish(const Start& start, Solution& solution);

 private:
  /// A spline and the matches' places in it.
  struct Grid {
    DisplacementSpline spline;
    std::vector<DisplacementSpline::Site> sites;

    Grid(const Matches& matches, const SplineDomain& domain);
    Eigen::Vector2d displacement_px(Eigen::Index i) const { return spline(sites[to_index(i)]); }
    Eigen::Matrix2d slope(Eigen::Index i) const { return spline.slope(sites[to_index(i)]); }
  };
  struct State;

  void gather(const Points2& residual_px, Eigen::Index most, State& state) const;
  Points2 residuals_px(const State& state) const;
  void gather_again(const Start& start, State& state) const;
  void improve(const Start& start, State& state) const;
  void look_again(const Start& start, const Isolated& isolated, State& state,
                  Solution& solution) const;
  void sharpen(const Start& start, State& state, Solution& best);
  Solution solution_of(const Start& start, const State& state) const;
  double typical_scale(const Start& start, const State& state) const;
  void conclude(const State& state, Solution& solution) const;
  Eigen::ArrayXd biases(const Start& start, const Grid& grid,
                        const std::vector<Eigen::Index>& rows) const;
  double logit_constant(double sigma_px, double share) const;

  const Matches& matches_;
  AnnealingOptions options_;
  Grid coarse_, fine_;
  std::vector<Eigen::Index> all_;  ///< 0 to n - 1
};

}  // namespace weft::aem
