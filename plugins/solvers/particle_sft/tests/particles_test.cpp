// SPDX-License-Identifier: Apache-2.0
#include "particles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <weft/core/rng.hpp>

namespace weft::particle_sft {
namespace {

constexpr std::int32_t kCount = 9;

std::vector<Particle> drawn_particles(Rng& rng) {
  std::vector<Particle> particles(kCount + 1);
  for (std::int32_t v = 0; v < kCount; ++v) {
    for (int k = 0; k < 3; ++k) particles[v].m[k] = rng.uniform(-1.0, 1.0);
  }
  return particles;
}

void expect_same(const std::vector<Particle>& a, const std::vector<Particle>& b) {
  for (std::size_t v = 0; v < a.size(); ++v) EXPECT_EQ(a[v].m, b[v].m) << "particle " << v;
}

/// One spring after the other, as in the equation.
void pull_together(double half, double rest_length_m, Particle& a, Particle& b) {
  const double dx = b.m[0] - a.m[0], dy = b.m[1] - a.m[1], dz = b.m[2] - a.m[2];
  const double length2 = dx * dx + dy * dy + dz * dz;
  if (length2 < 1e-18) return;
  const double share = half - half * rest_length_m / std::sqrt(length2);
  const double way[3] = {share * dx, share * dy, share * dz};
  for (int k = 0; k < 3; ++k) {
    a.m[k] += way[k];
    b.m[k] -= way[k];
  }
}

TEST(Particles, SpringsSideBySideGiveTheBitsOfOneAfterTheOther) {
  Rng rng(61);
  for (int draw = 0; draw < 50; ++draw) {
    std::vector<Particle> expected = drawn_particles(rng);
    expected[1] = expected[0];  // in one place: left alone until others part them
    std::vector<Particle> found = expected;
    std::vector<SpringQuad> quads;
    QuadBuilder builder(kCount);
    for (int spring = 0; spring < 40; ++spring) {
      const auto ends = spring == 0 ? std::vector<int>{0, 1} : rng.sample(kCount, 2);
      const double rest_length_m = rng.uniform(0.0, 1.0);
      pull_together(0.4, rest_length_m, expected[ends[0]], expected[ends[1]]);
      add(ends[0], ends[1], rest_length_m, builder, quads);
    }
    EXPECT_LT(quads.size(), 40U);
    sweep(quads.data(), quads.size(), 0.4, found.data());
    expect_same(found, expected);
  }
}

TEST(Particles, RaysSideBySideGiveTheBitsOfOneAfterTheOther) {
  Rng rng(62);
  std::vector<Particle> expected = drawn_particles(rng), found = expected;
  std::vector<RayQuad> quads;
  QuadBuilder builder(kCount);
  for (int seen = 0; seen < 30; ++seen) {
    const int v = seen % 7;
    const double trust = seen < 20 ? 1.0 : rng.uniform(0.0, 1.0);
    const std::array<double, 3> ray{rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), 0.8};
    add(v, ray, trust, builder, quads);
    auto& p = expected[v].m;
    const double depth = std::abs(p[0] * ray[0] + p[1] * ray[1] + p[2] * ray[2]);
    for (int k = 0; k < 3; ++k) {
      p[k] = trust == 1.0 ? depth * ray[k] : p[k] + trust * (depth * ray[k] - p[k]);
    }
  }
  put_on_rays(quads, found.data());
  expect_same(found, expected);
}

TEST(Particles, MoveByWhatIsKeptOfTheirVelocity) {
  Rng rng(63);
  std::vector<Particle> place = drawn_particles(rng), velocity = drawn_particles(rng);
  const std::vector<Particle> before = place;
  std::vector<Particle> fresh(kCount + 1);
  predict(place.data(), velocity.data(), 0.5, kCount, fresh.data());
  double expected = 0.0;
  for (std::size_t v = 0; v < kCount; ++v) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(fresh[v].m[k], place[v].m[k] + 0.5 * velocity[v].m[k]);
      expected += 0.25 * velocity[v].m[k] * velocity[v].m[k];
    }
  }
  EXPECT_NEAR(take_step(fresh.data(), kCount, place.data(), velocity.data()), expected, 1e-12);
  expect_same(place, fresh);
  EXPECT_EQ(velocity[3].m[1], fresh[3].m[1] - before[3].m[1]);
}

}  // namespace
}  // namespace weft::particle_sft
