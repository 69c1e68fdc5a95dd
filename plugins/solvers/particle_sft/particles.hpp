// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace weft::particle_sft {

/// A place or a velocity: x, y, z and 0, so that a processor takes all of it at once.
struct alignas(32) Particle {
  std::array<double, 4> m{};  ///< m, camera frame
};

/// Up to four constraints that follow each other and share no particle. Side by side they give the
/// same bits as one after the other. Unused slots of the SIMD vector act on a spare particle behind
/// the others, which stays at 0.
struct SpringQuad {
  std::array<std::int32_t, 4> i{}, j{};   ///< particles at its ends
  std::array<double, 4> rest_length_m{};  ///< m
};

struct RayQuad {
  std::array<std::int32_t, 4> i{};  ///< particles
  std::array<Particle, 4> ray{};    ///< unit, camera frame
  std::array<double, 4> trust{};    ///< share of the way to the ray
  bool whole = true;                ///< all of it
};

/// Gathers constraints into quads in the order in which they are added.
class QuadBuilder {
 public:
  /// `spare` is the particle of unused slots.
  explicit QuadBuilder(std::int32_t spare) : spare_(spare) {}

  /// Slot of the next constraint, which acts on these two; 0 where a new quad begins.
  std::size_t lane(std::int32_t a, std::int32_t b);
  std::int32_t spare() const { return spare_; }

 private:
  std::int32_t spare_;
  std::size_t count_ = 4;
  std::array<std::int32_t, 8> taken_{};
};

void add(std::int32_t i, std::int32_t j, double rest_length_m, QuadBuilder& builder,
         std::vector<SpringQuad>& quads);
void add(std::int32_t i, const std::array<double, 3>& ray, double trust, QuadBuilder& builder,
         std::vector<RayQuad>& quads);

/// Moves the ends of springs along their difference d by half (|d| - rest length) each, one spring
/// after the other. Ends closer than 1e-9 m are left alone.
void sweep(const SpringQuad* quads, std::size_t count, double half, Particle* y);

/// Puts particles on their rays, or part of the way. One behind the camera goes in front of it.
void put_on_rays(const std::vector<RayQuad>& quads, Particle* y);

/// y = x + kept v over `count` particles.
void predict(const Particle* x, const Particle* v, double kept, std::size_t count, Particle* y);

/// v = y - x, x = y; returns |v|^2.
double take_step(const Particle* y, std::size_t count, Particle* x, Particle* v);

}  // namespace weft::particle_sft
