// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>

namespace weft {

/// PCG32 (XSH-RR 64/32, O'Neill 2014) with its own distributions. Results are the same with every
/// compiler and standard library. Golden values in the tests fix the sequence.
class Rng {
 public:
  explicit Rng(std::uint64_t seed) {
    next_u32();
    state_ += seed;
    next_u32();
  }

  /// Draws uniformly from all 32-bit values.
  std::uint32_t next_u32() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + kIncrement;
    const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
    const auto rotation = static_cast<std::uint32_t>(old >> 59U);
    return (shifted >> rotation) | (shifted << ((32U - rotation) & 31U));
  }

  /// Draws uniformly from [0, bound), without bias. Requires bound > 0.
  std::uint32_t below(std::uint32_t bound) {
    const std::uint32_t threshold = (0U - bound) % bound;
    for (;;) {
      const std::uint32_t draw = next_u32();
      if (draw >= threshold) return draw % bound;
    }
  }

  /// Draws uniformly from [0, 1) with 53 bits.
  double uniform() {
    const std::uint64_t high = next_u32() >> 5U;
    const std::uint64_t low = next_u32() >> 6U;
    return static_cast<double>((high << 26U) | low) * 0x1.0p-53;
  }

  /// Draws uniformly from [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Draws from the standard normal distribution (Marsaglia's polar method).
  double normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    double u = 0.0, v = 0.0, s = 0.0;
    do {
      u = uniform(-1.0, 1.0);
      v = uniform(-1.0, 1.0);
      s = u * u + v * v;
    } while (s >= 1.0 || s == 0.0);
    const double factor = std::sqrt(-2.0 * std::log(s) / s);
    spare_ = v * factor;
    has_spare_ = true;
    return u * factor;
  }

  /// Shuffles with the Fisher-Yates algorithm.
  template <class T>
  void shuffle(std::vector<T>& values) {
    for (std::size_t i = values.size(); i > 1; --i) {
      std::swap(values[i - 1], values[below(static_cast<std::uint32_t>(i))]);
    }
  }

  /// Draws `count` distinct indices from [0, population), in drawing order. Requires count <=
  /// population.
  std::vector<int> sample(int population, int count) {
    std::vector<int> indices(to_index(population));
    std::iota(indices.begin(), indices.end(), 0);
    for (int i = 0; i < count; ++i) {
      const auto j = i + static_cast<int>(below(static_cast<std::uint32_t>(population - i)));
      std::swap(indices[to_index(i)], indices[to_index(j)]);
    }
    indices.resize(to_index(count));
    return indices;
  }

 private:
  static constexpr std::uint64_t kIncrement = 1442695040888963407ULL;
  std::uint64_t state_ = 0;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace weft
