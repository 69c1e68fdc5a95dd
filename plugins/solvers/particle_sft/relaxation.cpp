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

constexpr int kStallWindow = 200;  // the step of a swinging surface falls and rises for about 100
constexpr double kStallFactor = 0.99;
constexpr int kAskEvery = 8;

/// The host may cancel between two parts.
void sweep_in_parts(const std::vector<SpringQuad>& quads, double stiffness, Particle* y) {
  constexpr std::size_t kPart = 16384;
  for (std::size_t first = 0; first < quads.size(); first += kPart) {
    const std::size_t count = std::min(kPart, quads.size() - first);
    worked(static_cast<std::int64_t>(4 * count));
    sweep(quads.data() + first, count, 0.5 * stiffness, y);
  }
}

/// Moves a point of the surface to the border of its sphere if it is outside: a vertex itself, the
/// corners of a face in proportion to their weights.
void bring_into_sphere(const KnownSurfacePoint& sphere, Particle* y) {
  using Place = Eigen::Map<Eigen::Vector3d>;
  const auto corner = [&](std::size_t k) { return Place(y[sphere.vertices[k]].m.data()); };
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

std::vector<std::uint8_t> observed_vertices(const std::vector<RayConstraint>& rays,
                                            const std::vector<KnownSurfacePoint>& known,
                                            Eigen::Index vertex_count) {
  std::vector<std::uint8_t> observed(to_index(vertex_count), 0);
  const auto mark = [&](const auto& points) {
    for (const auto& point : points) {
      for (const std::int32_t v : point.vertices) observed[to_index(v)] = 1;
    }
  };
  mark(rays);
  mark(known);
  return observed;
}

void Relaxation::load(const ParticleSystem& system) {
  const auto spare = static_cast<std::int32_t>(shares_.size());
  const auto pack = [&](const std::vector<DistanceConstraint>& from, std::vector<SpringQuad>& to) {
    to.clear();
    QuadBuilder builder(spare);
    for (const DistanceConstraint& c : from) {
      add(c.i, c.j, c.rest_length_m, builder, to);
    }
  };
  pack(system.stretch, stretch_);
  pack(system.bending, bending_);
  at_vertices_.clear();
  in_faces_.clear();
  std::fill(shares_.begin(), shares_.end(), 0.0);
  QuadBuilder builder(spare);
  for (const RayConstraint& seen : system.rays) {
    if (seen.at_vertex()) {
      add(seen.vertices[0], seen.ray, seen.trust, builder, at_vertices_);
      continue;
    }
    in_faces_.push_back(seen);
    for (std::size_t c = 0; c < 3; ++c) {
      shares_[to_index(seen.vertices[c])] += std::abs(seen.weights[c]);
    }
  }
}

/// Moves every vertex by the weighted mean of what the points in its faces lack to their rays
/// (simultaneous, as in SART). One after the other they would amplify the velocity.
void Relaxation::pull_faces(Particle* y) {
  std::fill(pull_.begin(), pull_.end(), Particle{});
  for (const RayConstraint& seen : in_faces_) {
    double point[3] = {0.0, 0.0, 0.0};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& p = y[seen.vertices[c]].m;
      for (std::size_t k = 0; k < 3; ++k) point[k] += seen.weights[c] * p[k];
    }
    const double depth =
        std::abs(point[0] * seen.ray[0] + point[1] * seen.ray[1] + point[2] * seen.ray[2]);
    for (std::size_t c = 0; c < 3; ++c) {
      auto& pull = pull_[to_index(seen.vertices[c])].m;
      for (std::size_t k = 0; k < 3; ++k) {
        pull[k] += seen.trust * seen.weights[c] * (depth * seen.ray[k] - point[k]);
      }
    }
  }
  for (std::size_t v = 0; v < shares_.size(); ++v) {
    if (shares_[v] == 0.0) continue;
    for (std::size_t k = 0; k < 3; ++k) y[v].m[k] += pull_[v].m[k] / shares_[v];
  }
}

/// One iteration; the rms step in m.
double Relaxation::iterate(const ParticleSystem& system, const RelaxationOptions& options) {
  const std::size_t count = shares_.size();
  Particle* y = fresh_.data();
  predict(place_.data(), velocity_.data(), 1.0 - options.damping, count, y);
  put_on_rays(at_vertices_, y);
  if (!in_faces_.empty()) pull_faces(y);
  for (int inner = 0; inner < options.solver_iterations; ++inner) {
    sweep_in_parts(stretch_, options.stretch_stiffness, y);
    sweep_in_parts(bending_, options.bend_stiffness, y);
    for (const KnownSurfacePoint& sphere : system.spheres) bring_into_sphere(sphere, y);
  }
  const double sum2 = take_step(y, count, place_.data(), velocity_.data());
  return std::sqrt(sum2 / static_cast<double>(count));
}

RelaxationResult Relaxation::run(const ParticleSystem& system, const RelaxationOptions& options,
                                 Points3& vertices_m, const std::function<bool()>& cancelled) {
  using Places = Eigen::Map<Points3, 0, Eigen::OuterStride<4>>;
  const std::size_t size = to_index(vertices_m.rows()) + 1;
  place_.assign(size, {});
  fresh_.assign(size, {});
  velocity_.assign(size, {});
  pull_.resize(size);
  shares_.resize(size - 1);
  load(system);
  Places places_m(place_.front().m.data(), vertices_m.rows(), 3);
  places_m = vertices_m;
  RelaxationResult result;
  double smallest = std::numeric_limits<double>::infinity();
  double smallest_before = smallest;
  while (result.iterations < options.max_iterations) {
    const double step = iterate(system, options);
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
  vertices_m = places_m;
  return result;
}

}  // namespace weft::particle_sft
