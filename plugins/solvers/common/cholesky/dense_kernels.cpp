// SPDX-License-Identifier: Apache-2.0
#include "common/cholesky/dense_kernels.hpp"

#include <algorithm>
#include <cmath>

namespace weft::solvers {
namespace {

/// Turned by compilers into what the processor has. Without FMA, which rounds otherwise, all
/// processors give the same.
typedef double Four
    __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double)), may_alias));

[[gnu::always_inline]] inline Four& four(double* at) { return *reinterpret_cast<Four*>(at); }
[[gnu::always_inline]] inline const Four& four(const double* at) {
  return *reinterpret_cast<const Four*>(at);
}

[[gnu::always_inline]] inline void any_subtract_product(const Panel& c, const Panel& a,
                                                        const Panel& b, std::size_t rows,
                                                        std::size_t depth) {
  for (std::size_t r = 0; r < rows; r += kTileRows) {
    Four low0 = four(&c(r, 0)), low1 = four(&c(r, 1)), low2 = four(&c(r, 2)), low3 = four(&c(r, 3));
    Four high0 = four(&c(r + 4, 0)), high1 = four(&c(r + 4, 1)), high2 = four(&c(r + 4, 2)),
         high3 = four(&c(r + 4, 3));
    const double* from_a = &a(r, 0);
    const double* from_b = b.data;
    for (std::size_t k = 0; k < depth; ++k, from_a += a.stride, from_b += b.stride) {
      const Four low = four(from_a), high = four(from_a + 4);
      low0 -= low * from_b[0];
      high0 -= high * from_b[0];
      low1 -= low * from_b[1];
      high1 -= high * from_b[1];
      low2 -= low * from_b[2];
      high2 -= high * from_b[2];
      low3 -= low * from_b[3];
      high3 -= high * from_b[3];
    }
    four(&c(r, 0)) = low0;
    four(&c(r, 1)) = low1;
    four(&c(r, 2)) = low2;
    four(&c(r, 3)) = low3;
    four(&c(r + 4, 0)) = high0;
    four(&c(r + 4, 1)) = high1;
    four(&c(r + 4, 2)) = high2;
    four(&c(r + 4, 3)) = high3;
  }
}

void subtract_product_plain(const Panel& c, const Panel& a, const Panel& b, std::size_t rows,
                            std::size_t depth) {
  any_subtract_product(c, a, b, rows, depth);
}

#ifdef __x86_64__
[[gnu::target("avx2")]] void subtract_product_avx2(const Panel& c, const Panel& a, const Panel& b,
                                                   std::size_t rows, std::size_t depth) {
  any_subtract_product(c, a, b, rows, depth);
}

const auto kSubtractProduct =
    __builtin_cpu_supports("avx2") ? subtract_product_avx2 : subtract_product_plain;
#else
constexpr auto kSubtractProduct = subtract_product_plain;
#endif

}  // namespace

void subtract_product(const Panel& c, const Panel& a, const Panel& b, std::size_t rows,
                      std::size_t depth) {
  kSubtractProduct(c, a, b, rows, depth);
}

void scale(double* column, std::size_t count, double factor) {
  for (std::size_t r = 0; r < count; r += 4) four(column + r) *= factor;
}

void subtract_multiple(double* column, const double* other, std::size_t count, double factor) {
  for (std::size_t r = 0; r < count; r += 4) {
    four(column + r) -= factor * four(other + r);
  }
}

bool factorise_columns(const Panel& panel, std::size_t rows, std::size_t columns) {
  for (std::size_t from = 0; from < columns; from += kTileColumns) {
    subtract_product(panel.from(from, from), panel.from(from, 0), panel.from(from, 0), rows - from,
                     from);
    const std::size_t end = std::min(from + kTileColumns, columns);
    for (std::size_t j = from; j < end; ++j) {
      const double pivot = panel(j, j);
      if (!(pivot > 0.0) || !std::isfinite(pivot)) return false;
      const double root = std::sqrt(pivot), inverse = 1.0 / root;
      scale(&panel(j, j), rows - j, inverse);
      panel(j, j) = root;
      for (std::size_t later = j + 1; later < end; ++later) {
        subtract_multiple(&panel(later, later), &panel(later, j), rows - later, panel(later, j));
      }
    }
  }
  return true;
}

}  // namespace weft::solvers
