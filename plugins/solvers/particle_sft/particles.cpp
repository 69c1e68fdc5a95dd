// SPDX-License-Identifier: Apache-2.0
#include "particles.hpp"

#include <algorithm>
#include <cmath>

#ifdef __x86_64__
#include <immintrin.h>
#endif

namespace weft::particle_sft {
namespace {

constexpr double kTooClose2 = 1e-18;  // m^2

/// Turned by compilers into what the processor has. Without FMA, which rounds otherwise, all
/// processors give the same.
typedef double Four __attribute__((vector_size(4 * sizeof(double)), may_alias));

[[gnu::always_inline]] inline Four& at(Particle& particle) {
  return reinterpret_cast<Four&>(particle);
}
[[gnu::always_inline]] inline const Four& at(const Particle& particle) {
  return reinterpret_cast<const Four&>(particle);
}

[[gnu::always_inline]] inline void any_predict(const Particle* x, const Particle* v, double kept,
                                               std::size_t count, Particle* y) {
  for (std::size_t k = 0; k < count; ++k) at(y[k]) = at(x[k]) + kept * at(v[k]);
}

[[gnu::always_inline]] inline double any_take_step(const Particle* y, std::size_t count,
                                                   Particle* x, Particle* v) {
  Four sums{};
  for (std::size_t k = 0; k < count; ++k) {
    const Four fresh = at(y[k]), step = fresh - at(x[k]);
    sums += step * step;
    at(v[k]) = step;
    at(x[k]) = fresh;
  }
  return (sums[0] + sums[1]) + sums[2];
}

void predict_plain(const Particle* x, const Particle* v, double kept, std::size_t count,
                   Particle* y) {
  any_predict(x, v, kept, count, y);
}

double take_step_plain(const Particle* y, std::size_t count, Particle* x, Particle* v) {
  return any_take_step(y, count, x, v);
}

void sweep_plain(const SpringQuad* quads, std::size_t count, double half, Particle* y) {
  for (const SpringQuad* quad = quads; quad != quads + count; ++quad) {
    for (std::size_t lane = 0; lane < 4; ++lane) {
      auto& a = y[quad->i[lane]].m;
      auto& b = y[quad->j[lane]].m;
      const double dx = b[0] - a[0], dy = b[1] - a[1], dz = b[2] - a[2];
      const double length2 = dx * dx + dy * dy + dz * dz;
      if (length2 < kTooClose2) continue;
      const double share = half - half * quad->rest_length_m[lane] / std::sqrt(length2);
      a[0] += share * dx;
      a[1] += share * dy;
      a[2] += share * dz;
      b[0] -= share * dx;
      b[1] -= share * dy;
      b[2] -= share * dz;
    }
  }
}

void put_on_ray(const RayQuad& quad, std::size_t lane, Particle* y) {
  auto& p = y[quad.i[lane]].m;
  const auto& ray = quad.ray[lane].m;
  const double depth = std::abs(p[0] * ray[0] + p[1] * ray[1] + p[2] * ray[2]);
  const double trust = quad.trust[lane];
  for (std::size_t k = 0; k < 3; ++k) {
    const double target = depth * ray[k];
    p[k] = trust == 1.0 ? target : p[k] + trust * (target - p[k]);
  }
}

void put_on_rays_plain(const RayQuad* quads, std::size_t count, Particle* y) {
  for (const RayQuad* quad = quads; quad != quads + count; ++quad) {
    for (std::size_t lane = 0; lane < 4; ++lane) put_on_ray(*quad, lane, y);
  }
}

#ifdef __x86_64__
/// x + y + z of four particles, in this order.
[[gnu::target("avx2"), gnu::always_inline]] inline __m256d sums_avx2(__m256d a, __m256d b,
                                                                     __m256d c, __m256d d) {
  const __m256d ab = _mm256_hadd_pd(a, b), cd = _mm256_hadd_pd(c, d);
  return _mm256_add_pd(_mm256_permute2f128_pd(ab, cd, 0x20), _mm256_permute2f128_pd(ab, cd, 0x31));
}

/// One number in all slots.
template <int lane>
[[gnu::target("avx2"), gnu::always_inline]] inline __m256d spread_avx2(__m256d numbers) {
  return _mm256_permute4x64_pd(numbers, lane * 0x55);
}

[[gnu::target("avx2"), gnu::always_inline]] inline void pull_avx2(__m256d share, __m256d gap,
                                                                  double* a, double* b,
                                                                  __m256d from, __m256d to) {
  const __m256d way = _mm256_mul_pd(share, gap);
  _mm256_store_pd(a, _mm256_add_pd(from, way));
  _mm256_store_pd(b, _mm256_sub_pd(to, way));
}

[[gnu::target("avx2")]] void sweep_avx2(const SpringQuad* quads, std::size_t count, double half,
                                        Particle* y) {
  const __m256d halves = _mm256_set1_pd(half), too_close2 = _mm256_set1_pd(kTooClose2);
  for (const SpringQuad* quad = quads; quad != quads + count; ++quad) {
    double *a0 = y[quad->i[0]].m.data(), *a1 = y[quad->i[1]].m.data(), *a2 = y[quad->i[2]].m.data(),
           *a3 = y[quad->i[3]].m.data();
    double *b0 = y[quad->j[0]].m.data(), *b1 = y[quad->j[1]].m.data(), *b2 = y[quad->j[2]].m.data(),
           *b3 = y[quad->j[3]].m.data();
    const __m256d from0 = _mm256_load_pd(a0), from1 = _mm256_load_pd(a1),
                  from2 = _mm256_load_pd(a2), from3 = _mm256_load_pd(a3);
    const __m256d to0 = _mm256_load_pd(b0), to1 = _mm256_load_pd(b1), to2 = _mm256_load_pd(b2),
                  to3 = _mm256_load_pd(b3);
    const __m256d gap0 = _mm256_sub_pd(to0, from0), gap1 = _mm256_sub_pd(to1, from1),
                  gap2 = _mm256_sub_pd(to2, from2), gap3 = _mm256_sub_pd(to3, from3);
    const __m256d length2 = sums_avx2(_mm256_mul_pd(gap0, gap0), _mm256_mul_pd(gap1, gap1),
                                      _mm256_mul_pd(gap2, gap2), _mm256_mul_pd(gap3, gap3));
    const __m256d wanted = _mm256_mul_pd(halves, _mm256_loadu_pd(quad->rest_length_m.data()));
    __m256d share = _mm256_sub_pd(halves, _mm256_div_pd(wanted, _mm256_sqrt_pd(length2)));
    share = _mm256_andnot_pd(_mm256_cmp_pd(length2, too_close2, _CMP_LT_OQ), share);
    pull_avx2(spread_avx2<0>(share), gap0, a0, b0, from0, to0);
    pull_avx2(spread_avx2<1>(share), gap1, a1, b1, from1, to1);
    pull_avx2(spread_avx2<2>(share), gap2, a2, b2, from2, to2);
    pull_avx2(spread_avx2<3>(share), gap3, a3, b3, from3, to3);
  }
}

[[gnu::target("avx2")]] void put_on_rays_avx2(const RayQuad* quads, std::size_t count,
                                              Particle* y) {
  const __m256d sign = _mm256_set1_pd(-0.0);
  for (const RayQuad* quad = quads; quad != quads + count; ++quad) {
    if (!quad->whole) {
      for (std::size_t lane = 0; lane < 4; ++lane) put_on_ray(*quad, lane, y);
      continue;
    }
    const __m256d ray0 = _mm256_load_pd(quad->ray[0].m.data()),
                  ray1 = _mm256_load_pd(quad->ray[1].m.data()),
                  ray2 = _mm256_load_pd(quad->ray[2].m.data()),
                  ray3 = _mm256_load_pd(quad->ray[3].m.data());
    double *p0 = y[quad->i[0]].m.data(), *p1 = y[quad->i[1]].m.data(), *p2 = y[quad->i[2]].m.data(),
           *p3 = y[quad->i[3]].m.data();
    const __m256d along =
        sums_avx2(_mm256_mul_pd(_mm256_load_pd(p0), ray0), _mm256_mul_pd(_mm256_load_pd(p1), ray1),
                  _mm256_mul_pd(_mm256_load_pd(p2), ray2), _mm256_mul_pd(_mm256_load_pd(p3), ray3));
    const __m256d depth = _mm256_andnot_pd(sign, along);
    _mm256_store_pd(p0, _mm256_mul_pd(spread_avx2<0>(depth), ray0));
    _mm256_store_pd(p1, _mm256_mul_pd(spread_avx2<1>(depth), ray1));
    _mm256_store_pd(p2, _mm256_mul_pd(spread_avx2<2>(depth), ray2));
    _mm256_store_pd(p3, _mm256_mul_pd(spread_avx2<3>(depth), ray3));
  }
}

[[gnu::target("avx2")]] void predict_avx2(const Particle* x, const Particle* v, double kept,
                                          std::size_t count, Particle* y) {
  any_predict(x, v, kept, count, y);
}

[[gnu::target("avx2")]] double take_step_avx2(const Particle* y, std::size_t count, Particle* x,
                                              Particle* v) {
  return any_take_step(y, count, x, v);
}
#endif

struct Kernels {
  void (*predict)(const Particle*, const Particle*, double, std::size_t, Particle*);
  double (*take_step)(const Particle*, std::size_t, Particle*, Particle*);
  void (*sweep)(const SpringQuad*, std::size_t, double, Particle*);
  void (*put_on_rays)(const RayQuad*, std::size_t, Particle*);
};

constexpr Kernels kPlain{predict_plain, take_step_plain, sweep_plain, put_on_rays_plain};
#ifdef __x86_64__
const Kernels kKernels = __builtin_cpu_supports("avx2")
                             ? Kernels{predict_avx2, take_step_avx2, sweep_avx2, put_on_rays_avx2}
                             : kPlain;
#else
constexpr Kernels kKernels = kPlain;
#endif

}  // namespace

std::size_t QuadBuilder::lane(std::int32_t a, std::int32_t b) {
  const auto* end = taken_.begin() + 2 * count_;
  const bool is_shared =
      std::find(taken_.cbegin(), end, a) != end || std::find(taken_.cbegin(), end, b) != end;
  if (count_ == 4 || is_shared) count_ = 0;
  taken_[2 * count_] = a;
  taken_[2 * count_ + 1] = b;
  return count_++;
}

void add(std::int32_t i, std::int32_t j, double rest_length_m, QuadBuilder& builder,
         std::vector<SpringQuad>& quads) {
  const std::size_t lane = builder.lane(i, j);
  if (lane == 0) {
    quads.emplace_back();
    quads.back().i.fill(builder.spare());
    quads.back().j.fill(builder.spare());
  }
  quads.back().i[lane] = i;
  quads.back().j[lane] = j;
  quads.back().rest_length_m[lane] = rest_length_m;
}

void add(std::int32_t i, const std::array<double, 3>& ray, double trust, QuadBuilder& builder,
         std::vector<RayQuad>& quads) {
  const std::size_t lane = builder.lane(i, i);
  if (lane == 0) {
    quads.emplace_back();
    quads.back().i.fill(builder.spare());
    quads.back().trust.fill(1.0);
  }
  quads.back().i[lane] = i;
  std::copy(ray.begin(), ray.end(), quads.back().ray[lane].m.begin());
  quads.back().trust[lane] = trust;
  quads.back().whole &= trust == 1.0;
}

void sweep(const SpringQuad* quads, std::size_t count, double half, Particle* y) {
  kKernels.sweep(quads, count, half, y);
}

void put_on_rays(const std::vector<RayQuad>& quads, Particle* y) {
  kKernels.put_on_rays(quads.data(), quads.size(), y);
}

void predict(const Particle* x, const Particle* v, double kept, std::size_t count, Particle* y) {
  kKernels.predict(x, v, kept, count, y);
}

double take_step(const Particle* y, std::size_t count, Particle* x, Particle* v) {
  return kKernels.take_step(y, count, x, v);
}

}  // namespace weft::particle_sft
