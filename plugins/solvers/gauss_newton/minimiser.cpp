// SPDX-License-Identifier: Apache-2.0
#include "minimiser.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>

namespace weft::gauss_newton {
namespace {

// Shares of the mean of the diagonal of H.
constexpr double kFirstDamping = 1e-6, kLeastDamping = 1e-12, kMostDamping = 1e3;
constexpr double kFollowed = 0.5;
constexpr double kLeastLength = 0.05, kShort = 0.3;
constexpr double kLess = 0.1, kMore = 10.0;

double rms(const Points3& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.rows()));
}

}  // namespace

Result<void> Minimiser::prepare(const MeshModel& mesh) {
  energy_.prepare(mesh);
  matrix_.diagonal.resize(to_index(mesh.vertex_count()));
  matrix_.coupling.resize(mesh.couplings.size());
  gradient_.resize(mesh.vertex_count(), 3);
  step_m_.resize(mesh.vertex_count(), 3);
  tried_m_.resize(mesh.vertex_count(), 3);
  return factor_.analyse(mesh.rest_m, mesh.couplings);
}

/// The part of the step with the least energy, by a parabola through the energy here, its slope and
/// the energy at the end of the step. It is 0 where no step should be taken.
double Minimiser::length_of_step(const FrameData& frame, const Expectation& expected,
                                 const Scales& scales, double energy_here) {
  const double energy_there = energy_.value(frame, expected, scales, tried_m_);
  if (!std::isfinite(energy_there)) return 0.0;
  const double slope = gradient_.cwiseProduct(step_m_).sum();  // half of it
  const double bend = energy_there - energy_here - 2.0 * slope;
  const double length = bend > -slope ? -slope / bend : 1.0;
  return length < kLeastLength ? 0.0 : length;
}

MinimiserResult Minimiser::run(const FrameData& frame, const Expectation& expected,
                               const Scales& scales, const MinimiserOptions& options,
                               Points3& vertices_m) {
  MinimiserResult result;
  double damping = kFirstDamping;
  bool moved = true;
  while (true) {
    if (moved) {
      // Full correction of the chords for a ripple would produce the opposite ripple.
      energy_.follow(vertices_m, result.iterations == 0 ? 1.0 : kFollowed);
      energy_.meet_outline(frame, scales, vertices_m);
      result.energy = energy_.linearise(frame, expected, scales, vertices_m, gradient_, matrix_);
      if (!std::isfinite(result.energy)) {
        result.stop = Stop::not_finite;
        return result;
      }
    }
    if (result.stop == Stop::converged || result.iterations >= options.max_iterations) {
      return result;
    }
    ++result.iterations;
    moved = false;
    if (factor_.factorise(matrix_, damping * matrix_.mean_diagonal())) {
      step_m_ = -gradient_;
      factor_.solve(step_m_);
      tried_m_ = vertices_m + step_m_;
      const double length = length_of_step(frame, expected, scales, result.energy);
      moved = length > 0.0;
      vertices_m += length * step_m_;
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

}  // namespace weft::gauss_newton
