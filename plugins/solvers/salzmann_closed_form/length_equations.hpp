// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/geometry/distance_constraints.hpp>

#include "observed_shapes.hpp"

namespace weft::salzmann_closed_form {

/// The edges keep their lengths,  |sum_i beta_i (L_i^a - L_i^b)|^2 = l^2:
/// quadratic in beta, and linear in the products beta_i beta_j. Solved for the
/// first k shapes.
class LengthEquations {
 public:
  /// An edge may be off by a strain of `usual_strain`.
  LengthEquations(const ObservedShapes& observed, const std::vector<DistanceConstraint>& edges,
                  double usual_strain);

  /// The solution by linearisation. Least squares give the products b_ij, and the largest
  /// eigenvalue of the matrix b gives beta. The matrix is a product of beta if its second
  /// eigenvalue is small.
  Eigen::VectorXd linearised(int k) const;

  /// The solution by extended linearisation. Each equation, multiplied by each beta_m, is linear in
  /// the products of three and in beta. The linear part of the vector that solves these equations
  /// best has the direction of beta.
  Eigen::VectorXd extended(int k) const;

  /// Gauss-Newton on value(), at most `iterations` iterations.
  Eigen::VectorXd polished(Eigen::VectorXd beta, int iterations) const;

  /// sum over edges ((|d|^2 / l^2 - 1) / (2 usual_strain))^2 + cost of the
  /// shape
  double value(const Eigen::VectorXd& beta) const;

  /// Second over first eigenvalue of the products [k,k] of linearised().
  double rank_residual(int k) const;

 private:
  Eigen::MatrixXd compressed(int k) const;
  Eigen::MatrixXd products(int k) const;
  Eigen::VectorXd scaled(const Eigen::VectorXd& direction) const;
  Eigen::VectorXd stretches2(const Eigen::VectorXd& beta) const;

  Eigen::MatrixXd along_;  ///< [3E,k] L_i^a - L_i^b over l
  Eigen::VectorXd costs_;  ///< [k]
  double usual_strain_;
};

/// The best combination over all numbers of shapes up to `most`. Each number is combined by
/// linearisation, by extended linearisation and from the best of fewer shapes, and then polished.
/// Empty where nothing is finite.
Eigen::VectorXd best_combination(const LengthEquations& equations, int most, int polish_iterations);

}  // namespace weft::salzmann_closed_form
