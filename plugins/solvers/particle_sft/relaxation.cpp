// SPDX-License-Identifier: Apache-2.0
#include "relaxation.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::particle_sft {
namespace {

constexpr double kTooClose2 = 1e-18;  // m^2
constexpr int kStallWindow = 200;     // the step of a swinging sheet falls and rises for about 100
constexpr double kStallFactor = 0.99;
constexpr int kAskEvery = 8;

/// Puts a vertex on its ray, or part of the way. One behind the camera goes in front of it.
void put_on_ray(const RayConstraint& seen, double* y) {
  double* p = y + 3 * static_cast<std::ptrdiff_t>(seen.vertices[0]);
  const double depth = std::abs(p[0] * seen.ray[0] + p[1] * seen.ray[1] + p[2] * seen.ray[2]);
  for (std::size_t k = 0; k < 3; ++k) {
    const double target = depth * seen.ray[k];
    p[k] = seen.trust == 1.0 ? target : p[k] + seen.trust * (target - p[k]);
  }
}

template <class Springs>
void sweep(const Springs& springs, double stiffness, double* y) {
  const double half = 0.5 * stiffness;
  for (const auto& spring : springs) {
    double* a = y + spring.i;
    double* b = y + spring.j;
    const double dx = b[0] - a[0], dy = b[1] - a[1], dz = b[2] - a[2];
    const double length2 = dx * dx + dy * dy + dz * dz;
    if (length2 < kTooClose2) continue;
    const double share = half - half * spring.rest_length_m / std::sqrt(length2);
    a[0] += share * dx;
    a[1] += share * dy;
    a[2] += share * dz;
    b[0] -= share * dx;
    b[1] -= share * dy;
    b[2] -= share * dz;
  }
}

/// Between two parts the host may be asked.
template <class Spring>
void sweep_in_parts(const std::vector<Spring>& springs, double stiffness, double* y) {
  constexpr std::size_t kPart = 65536;
  for (std::size_t first = 0; first < springs.size(); first += kPart) {
    const std::span part(springs.data() + first, std::min(kPart, springs.size() - first));
    worked(static_cast<std::int64_t>(part.size()));
    sweep(part, stiffness, y);
  }
}

/// Moves a point of the surface to the border of its sphere if it is outside: a vertex itself, the
/// corners of a face in proportion to their weights.
void bring_into_sphere(const KnownSurfacePoint& sphere, double* y) {
  using Place = Eigen::Map<Eigen::Vector3d>;
  const auto corner = [&](std::size_t k) {
    return Place(y + 3 * static_cast<std::ptrdiff_t>(sphere.vertices[k]));
  };
  const bool at_vertex = sphere.vertex >= 0;
  Eigen::Vector3d offset = corner(0) - sphere.centre_m;
  double squares = 1.0;
  if (!at_vertex) {
    offset = -sphere.centre_m;
    squares = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      offset += sphere.weights[k] * corner(k);
      squares += sphere.weights[k] * sphere.weights[k];
    }
  }
  const double length2 = offset.squaredNorm();
  if (!(length2 > sphere.radius_m * sphere.radius_m)) return;
  const double scale = sphere.radius_m / std::sqrt(length2);
  if (at_vertex) {
    corner(0) = sphere.centre_m + scale * offset;
    return;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    corner(k) += sphere.weights[k] / squares * (scale - 1.0) * offset;
  }
}

}  // namespace

std::vector<std::uint8_t> held_vertices(const std::vector<RayConstraint>& rays,
                                        const std::vector<KnownSurfacePoint>& known,
                                        Eigen::Index vertex_count) {
  std::vector<std::uint8_t> held(to_index(vertex_count), 0);
  const auto mark = [&](const auto& points) {
    for (const auto& point : points) {
      for (const std::int32_t v : point.vertices) held[to_index(v)] = 1;
    }
  };
  mark(rays);
  mark(known);
  return held;
}

void Relaxation::load(const ParticleSystem& system) {
  const auto pack = [](const std::vector<DistanceConstraint>& from, std::vector<Spring>& to) {
    to.clear();
    for (const DistanceConstraint& c : from) to.push_back({3 * c.i, 3 * c.j, c.rest_length_m});
  };
  pack(system.stretch, stretch_);
  pack(system.bending, bending_);
  at_vertices_.clear();
  in_faces_.clear();
  std::fill(shares_.begin(), shares_.end(), 0.0);
  for (const RayConstraint& seen : system.rays) {
    (seen.at_vertex() ? at_vertices_ : in_faces_).push_back(seen);
    if (seen.at_vertex()) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      shares_[to_index(seen.vertices[c])] += std::abs(seen.weights[c]);
    }
  }
}

/// Moves every vertex by the weighted mean of what the points in its faces lack to their rays
/// (simultaneous, as in SART). One after the other they would amplify the velocity.
void Relaxation::pull_faces(double* y) {
  std::fill(pull_m_.begin(), pull_m_.end(), 0.0);
  for (const RayConstraint& seen : in_faces_) {
    double point[3] = {0.0, 0.0, 0.0};
    for (std::size_t c = 0; c < 3; ++c) {
      const double* p = y + 3 * static_cast<std::ptrdiff_t>(seen.vertices[c]);
      for (std::size_t k = 0; k < 3; ++k) point[k] += seen.weights[c] * p[k];
    }
    const double depth =
        std::abs(point[0] * seen.ray[0] + point[1] * seen.ray[1] + point[2] * seen.ray[2]);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t first = 3 * to_index(seen.vertices[c]);
      for (std::size_t k = 0; k < 3; ++k) {
        pull_m_[first + k] += seen.trust * seen.weights[c] * (depth * seen.ray[k] - point[k]);
      }
    }
  }
  for (std::size_t v = 0; v < shares_.size(); ++v) {
    if (shares_[v] == 0.0) continue;
    for (std::size_t k = 0; k < 3; ++k) y[3 * v + k] += pull_m_[3 * v + k] / shares_[v];
  }
}

/// One iteration on the coordinates x; the rms step in m.
double Relaxation::iterate(const ParticleSystem& system, const RelaxationOptions& options,
                           double* x) {
  const std::size_t size = fresh_m_.size();
  double* y = fresh_m_.data();
  double* velocity = velocity_m_.data();
  const double kept = 1.0 - options.damping;
  for (std::size_t k = 0; k < size; ++k) y[k] = x[k] + kept * velocity[k];
  for (const RayConstraint& seen : at_vertices_) put_on_ray(seen, y);
  if (!in_faces_.empty()) pull_faces(y);
  for (int inner = 0; inner < options.solver_iterations; ++inner) {
    sweep_in_parts(stretch_, options.stretch_stiffness, y);
    sweep_in_parts(bending_, options.bend_stiffness, y);
    for (const KnownSurfacePoint& sphere : system.spheres) bring_into_sphere(sphere, y);
  }
  double sum2 = 0.0;
  for (std::size_t k = 0; k < size; ++k) {
    velocity[k] = y[k] - x[k];
    sum2 += velocity[k] * velocity[k];
    x[k] = y[k];
  }
  return std::sqrt(3.0 * sum2 / static_cast<double>(size));
}

RelaxationResult Relaxation::run(const ParticleSystem& system, const RelaxationOptions& options,
                                 Points3& vertices_m, const std::function<bool()>& cancelled) {
  const auto size = to_index(vertices_m.size());
  fresh_m_.resize(size);
  pull_m_.resize(size);
  shares_.resize(size / 3);
  load(system);
  velocity_m_.assign(size, 0.0);
  RelaxationResult result;
  double smallest = std::numeric_limits<double>::infinity();
  double smallest_before = smallest;
  while (result.iterations < options.max_iterations) {
    const double step = iterate(system, options, vertices_m.data());
    ++result.iterations;
    result.last_step_m = step;
    if (!std::isfinite(step)) result.stop = Stop::not_finite;
    if (step < options.tolerance_m) result.stop = Stop::converged;
    if (result.iterations % kAskEvery == 0 && cancelled()) result.stop = Stop::cancelled;
    smallest = std::min(smallest, step);
    if (result.iterations % kStallWindow == 0) {
      if (smallest > kStallFactor * smallest_before) result.stop = Stop::stalled;
      smallest_before = smallest;
    }
    if (result.stop != Stop::iterations) break;
  }
  return result;
}

}  // namespace weft::particle_sft
