// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "kit/testing/geometry/answers.hpp"

/// How wrong answers are, and how wrong they may be.
namespace weft::testing {

/// Mean error of vertices below which a shape is right: 2 % of the template's diagonal, as its
/// confidence is defined in docs/records.md.
double shape_bound_m(const Template& templ);

/// Within this of its true place a match is correct.
inline constexpr double kMatchBound_px = MatchSpec{}.label_distance_px;

/// Share of matches, sightlines and vertices that may be wrong where all inputs are right.
inline constexpr double kShareBound = 0.05;

/// Mean distance of rows.
inline double mean_distance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).rowwise().norm().mean();
}

/// 200 matches, or 400 for components that judge them: filters by statistics of cells need 300.
/// Only these get mismatches. The labels hold for any noise, because mismatches are mostly far
/// away.
Scene drawn_scene(const Subject& subject, double mismatches, double noise_px, int round);

/// One output held against the truth of its scene.
struct Deviation {
  double value;      ///< [] mean distance in mm or px, or the share that is wrong
  double bound;      ///< [] that exact inputs must reach
  std::string what;  ///< "its shape is off by 3.1 mm in the mean"
};

/// The deviations of each output that has a truth; matches and vertices without an output count as
/// wrong.
std::vector<Deviation> deviations_of(const Scene& scene, const Asked& asked,
                                     const Points2& texels_px);

}  // namespace weft::testing
