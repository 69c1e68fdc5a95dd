// SPDX-License-Identifier: Apache-2.0
#include "minimiser.hpp"

#include <cmath>
#include <weft/core/index.hpp>

namespace weft::collins_integrated {
namespace {

// Share of the mean of the diagonal of H, which the lengths make large: bends must stay free.
constexpr double kFirstDamping = 1e-7;
constexpr double kMore = 10.0, kLess = 1.0 / 3.0;
constexpr int kMostRefusals = 5;
constexpr double kShortStep = 1e-4;  // mean edges

}  // namespace

Result<void> Minimiser::prepare(const MeshModel& mesh) {
  mesh_ = &mesh;
  energy_.prepare(mesh);
  matrix_.diagonal.resize(to_index(mesh.vertex_count()));
  matrix_.coupling.resize(mesh.couplings.size());
  gradient_.resize(mesh.vertex_count(), 3);
  step_m_.resize(mesh.vertex_count(), 3);
  tried_m_.resize(mesh.vertex_count(), 3);
  return factor_.analyse(mesh.rest_m, mesh.couplings);
}

MinimiserResult Minimiser::run(const FrameData& frame, const Scales& scales, int max_iterations,
                               Points3& vertices_m) {
  MinimiserResult result;
  double damping = kFirstDamping;
  int refusals = 0;
  energy_.follow(vertices_m);
  result.energy = energy_.linearise(frame, scales, vertices_m, gradient_, matrix_);
  while (std::isfinite(result.energy) && result.iterations < max_iterations) {
    ++result.iterations;
    bool moved = false;
    if (factor_.factorise(matrix_, damping * matrix_.mean_diagonal())) {
      step_m_ = -gradient_;
      factor_.solve(step_m_);
      tried_m_ = vertices_m + step_m_;
      moved = energy_.value(frame, scales, tried_m_) <= result.energy;
    }
    if (!moved) {
      damping *= kMore;
      if (++refusals > kMostRefusals) return result;
      continue;
    }
    refusals = 0;
    damping *= kLess;
    vertices_m = tried_m_;
    energy_.follow(vertices_m);
    result.energy = energy_.linearise(frame, scales, vertices_m, gradient_, matrix_);
    const double step_m = step_m_.norm() / std::sqrt(static_cast<double>(step_m_.rows()));
    result.converged = step_m < kShortStep * mesh_->mean_edge_m;
    if (result.converged) return result;
  }
  return result;
}

}  // namespace weft::collins_integrated
