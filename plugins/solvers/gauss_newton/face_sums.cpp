// SPDX-License-Identifier: Apache-2.0
#include "face_sums.hpp"

#include <algorithm>
#include <cmath>

namespace weft::gauss_newton {
namespace {

/// Four observations. Compilers turn it into what the processor has. Without FMA, which rounds
/// otherwise, all processors give the same.
typedef double Four __attribute__((vector_size(4 * sizeof(double))));

template <class T>
[[gnu::always_inline]] inline double sum_of(const T& four) {
  return (four[0] + four[1]) + (four[2] + four[3]);
}

template <bool wants_derivatives>
[[gnu::always_inline]] inline bool any_observe(const SeenFrom& from, const Observation* seen,
                                               std::size_t count, FaceSums& sums, double& energy) {
  const auto& [corners_m, rises_m, front, camera, trust] = from;
  const double scale2 = trust.scale * trust.scale;
  Four squares[6][6] = {}, slopes[3][3] = {}, energies{};
  for (std::size_t i = 0; i < count; i += 4) {
    // Missing ones are copies of the last one, without weight.
    const std::size_t last = count - 1;
    const Observation &o0 = seen[i], &o1 = seen[std::min(i + 1, last)],
                      &o2 = seen[std::min(i + 2, last)], &o3 = seen[std::min(i + 3, last)];
    const Four used = {1.0, i < last ? 1.0 : 0.0, i + 1 < last ? 1.0 : 0.0,
                       i + 2 < last ? 1.0 : 0.0};
    Four b[3];
    for (std::size_t k = 0; k < 3; ++k) {
      b[k] = Four{o0.weights[k], o1.weights[k], o2.weights[k], o3.weights[k]};
    }
    const Four seen_x = {o0.seen_px[0], o1.seen_px[0], o2.seen_px[0], o3.seen_px[0]};
    const Four seen_y = {o0.seen_px[1], o1.seen_px[1], o2.seen_px[1], o3.seen_px[1]};
    const Four white_xx = {o0.white.xx, o1.white.xx, o2.white.xx, o3.white.xx};
    const Four white_yx = {o0.white.yx, o1.white.yx, o2.white.yx, o3.white.yx};
    const Four white_yy = {o0.white.yy, o1.white.yy, o2.white.yy, o3.white.yy};
    const Four products[6] = {b[0] * b[0], b[1] * b[1], b[2] * b[2],
                              b[0] * b[1], b[1] * b[2], b[2] * b[0]};
    const Four rise_m =
        products[3] * rises_m[0] + products[4] * rises_m[1] + products[5] * rises_m[2];
    Four p[3];
    for (Eigen::Index k = 0; k < 3; ++k) {
      p[k] = b[0] * corners_m[0][k] + b[1] * corners_m[1][k] + b[2] * corners_m[2][k] -
             rise_m * front[k];
    }
    const Four inverse_z = 1.0 / p[2], px = p[0] * inverse_z, py = p[1] * inverse_z;
    for (std::size_t k = 0; k < 4; ++k) {
      if (!(p[2][k] > 0.0)) return false;
    }
    const Four off_x = camera.fx * px + camera.cx - seen_x;
    const Four off_y = camera.fy * py + camera.cy - seen_y;
    const Four rx = white_xx * off_x, ry = white_yx * off_x + white_yy * off_y;
    const Four r2 = rx * rx + ry * ry;
    Four weight = used, energy_here = r2;
    if (trust.redescends) {
      const Four share = scale2 / (scale2 + r2);
      energy_here *= share;
      weight *= share * share;
    } else {
      for (std::size_t k = 0; k < 4; ++k) {
        if (r2[k] <= scale2) continue;
        const double r = std::sqrt(r2[k]);
        energy_here[k] = trust.scale * (2.0 * r - trust.scale);
        weight[k] *= trust.scale / r;
      }
    }
    energies += used * energy_here;
    if constexpr (wants_derivatives) {
      const Four ax = camera.fx * white_xx * inverse_z, bx = camera.fx * white_yx * inverse_z;
      const Four by = camera.fy * white_yy * inverse_z;
      const Four az = -ax * px, bz = -(bx * px + by * py);
      const Four block[6] = {
          weight * (ax * ax + bx * bx), weight * bx * by, weight * by * by,
          weight * (ax * az + bx * bz), weight * by * bz, weight * (az * az + bz * bz)};
      for (std::size_t k = 0; k < 6; ++k) {
        for (std::size_t j = 0; j < 6; ++j) squares[k][j] += products[k] * block[j];
      }
      const Four gx = weight * (ax * rx + bx * ry), gy = weight * by * ry;
      const Four gz = -(gx * px + gy * py);
      for (std::size_t k = 0; k < 3; ++k) {
        slopes[k][0] += b[k] * gx;
        slopes[k][1] += b[k] * gy;
        slopes[k][2] += b[k] * gz;
      }
    }
  }
  energy += sum_of(energies);
  if constexpr (wants_derivatives) {
    for (std::size_t k = 0; k < 6; ++k) {
      for (std::size_t j = 0; j < 6; ++j) sums.squares[k][j] += sum_of(squares[k][j]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t j = 0; j < 3; ++j) sums.slopes[k][j] += sum_of(slopes[k][j]);
    }
  }
  return true;
}

using Observe = bool(const SeenFrom&, const Observation*, std::size_t, FaceSums&, double&);

template <bool wants_derivatives>
bool observe_plain(const SeenFrom& from, const Observation* seen, std::size_t count, FaceSums& sums,
                   double& energy) {
  return any_observe<wants_derivatives>(from, seen, count, sums, energy);
}

#ifdef __x86_64__
template <bool wants_derivatives>
[[gnu::target("avx2")]] bool observe_avx2(const SeenFrom& from, const Observation* seen,
                                          std::size_t count, FaceSums& sums, double& energy) {
  return any_observe<wants_derivatives>(from, seen, count, sums, energy);
}
Observe* const kObserve[2] = {
    __builtin_cpu_supports("avx2") ? observe_avx2<false> : observe_plain<false>,
    __builtin_cpu_supports("avx2") ? observe_avx2<true> : observe_plain<true>};
#else
Observe* const kObserve[2] = {observe_plain<false>, observe_plain<true>};
#endif

}  // namespace

bool FaceSums::observe(const SeenFrom& from, const Observation* seen, std::size_t count,
                       bool wants_derivatives, double& energy) {
  return kObserve[wants_derivatives ? 1 : 0](from, seen, count, *this, energy);
}

}  // namespace weft::gauss_newton
