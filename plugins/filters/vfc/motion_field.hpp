// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/geometry/types.hpp>

namespace weft::vfc {

struct Settings {
  double beta = 0.1;          ///< parameter of the kernel exp(-beta |x - y|^2), normalised
                              ///< coordinates
  double lambda = 3.0;        ///< weight of the field's smoothness
  double first_gamma = 0.9;   ///< initial share of inliers
  double theta = 0.75;        ///< probability from which a match counts as correct
  double mismatch_area = 10;  ///< a: mismatches have the density 1 / a
  int most_rounds = 500;
};

/// Probabilities that matches are correct.
struct Verdict {
  Eigen::VectorXd probability;  ///< [n]
  double gamma = 0.0;           ///< share of inliers
  double sigma = 0.0;           ///< standard deviation of the noise, normalised
  int rounds = 0;
};

/// A smooth field of motions and the matches that follow it, by expectation maximisation (Ma, Zhao,
/// Tian, Yuille and Tu 2014, algorithm 2). Motions [n,2] at places [n,2] are normalised; the field
/// is a sum of kernels at `centres` [m,2].
Verdict follow(const Points2& places, const Points2& motions, const Points2& centres,
               const Settings& settings);

}  // namespace weft::vfc
