// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>
#include <weft/sdk/budget.hpp>

#include "common/cholesky/block_cholesky.hpp"

namespace weft::solvers {

struct MinimiserOptions {
  int max_iterations = 30;         ///< []
  double tolerance_m = 1e-6;       ///< [] m, rms step at which to stop
  const Budget* budget = nullptr;  ///< ends the iteration, behind the first; null: nothing does
};

/// Why the iteration ended.
enum class Stop { converged = 0, stalled = 1, iterations = 2, not_finite = 3, budget = 4 };

struct MinimiserResult {
  Stop stop = Stop::iterations;
  int iterations = 0;        ///< [] factorisations
  double last_step_m = 0.0;  ///< [] m, rms over the vertices
  double energy = 0.0;       ///< []
};

/// Gauss-Newton with Levenberg's damping. Each iteration linearises the energy at the shape, solves
/// (H + damping I) step = -g and takes the step if the energy falls; then it damps less, or else
/// more. The result depends on the arguments alone; nothing is allocated.
class DampedNewton {
 public:
  /// Structure and memory for points at rest [V,3] m and the pairs of them that share a block of H.
  /// Fails where the factor is too large.
  Result<void> prepare(const Points3View& rest_m, const BlockCholesky::Pairs& pairs) {
    matrix_.diagonal.resize(to_index(rest_m.rows()));
    matrix_.coupling.resize(pairs.size());
    gradient_.resize(rest_m.rows(), 3);
    step_m_.resize(rest_m.rows(), 3);
    tried_m_.resize(rest_m.rows(), 3);
    return factor_.analyse(rest_m, pairs);
  }

  /// Moves points [V,3] m, which must be finite. `linearise(iteration, points_m, gradient, matrix)`
  /// returns the energy and writes half its gradient [V,3] and half its Gauss-Newton matrix;
  /// `value(points_m)` returns the energy, which may be infinite.
  template <class Linearise, class Value>
  MinimiserResult run(const MinimiserOptions& options, Linearise&& linearise, Value&& value,
                      Points3& points_m) {
    MinimiserResult result;
    double damping = kFirstDamping;
    bool moved = true;
    while (true) {
      if (moved) {
        result.energy = linearise(result.iterations, points_m, gradient_, matrix_);
        if (!std::isfinite(result.energy)) {
          result.stop = Stop::not_finite;
          return result;
        }
      }
      if (result.stop == Stop::converged || result.iterations >= options.max_iterations) {
        return result;
      }
      if (result.iterations > 0 && options.budget != nullptr && options.budget->is_spent()) {
        result.stop = Stop::budget;
        return result;
      }
      ++result.iterations;
      moved = false;
      if (factor_.factorise(matrix_, damping * matrix_.mean_diagonal())) {
        step_m_ = -gradient_;
        factor_.solve(step_m_);
        tried_m_ = points_m + step_m_;
        const double length = length_of_step(result.energy, value(tried_m_));
        moved = length > 0.0;
        points_m += length * step_m_;
        result.last_step_m = length * rms(step_m_);
        if (moved && result.last_step_m < options.tolerance_m) result.stop = Stop::converged;
        if (length < kShort) damping = std::max(damping, kFirstDamping);
      }
      damping = moved ? std::max(kLess * damping, kLeastDamping) : kMore * damping;
      if (!moved && damping > kMostDamping) {
        result.stop = Stop::stalled;
        return result;
      }
    }
  }

  BlockCholesky& factor() { return factor_; }
  BlockMatrix& matrix() { return matrix_; }

 private:
  // Shares of the mean of the diagonal of H.
  static constexpr double kFirstDamping = 1e-6, kLeastDamping = 1e-12, kMostDamping = 1e3;
  static constexpr double kLeastLength = 0.05, kShort = 0.3;
  static constexpr double kLess = 0.1, kMore = 10.0;

  static double rms(const Points3& values) {
    return std::sqrt(values.squaredNorm() / static_cast<double>(values.rows()));
  }

  /// The part of the step with the least energy, by a parabola through the energy here, its slope
  /// and the energy at the end of the step. It is 0 where no step should be taken.
  double length_of_step(double energy_here, double energy_there) const {
    if (!std::isfinite(energy_there)) return 0.0;
    const double slope = gradient_.cwiseProduct(step_m_).sum();  // half of it
    const double bend = energy_there - energy_here - 2.0 * slope;
    const double length = bend > -slope ? -slope / bend : 1.0;
    return length < kLeastLength ? 0.0 : length;
  }

  BlockMatrix matrix_;
  BlockCholesky factor_;
  Points3 gradient_, step_m_, tried_m_;  ///< [V,3]
};

}  // namespace weft::solvers
