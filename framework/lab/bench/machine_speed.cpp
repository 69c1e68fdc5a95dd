// SPDX-License-Identifier: Apache-2.0
#include "lab/bench/machine_speed.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>
#include <weft/core/index.hpp>

namespace weft::bench {
namespace {

constexpr int kTries = 5;
constexpr double kTry_ms = 10.0;
constexpr std::size_t kMemoryBlock_bytes = std::size_t{128} << 20U;  // size of source and of target

/// Keeps the compiler from removing the writes to this memory.
void keep(const void* address) { asm volatile("" : : "g"(address) : "memory"); }

/// The most times a second that `work` was done.
template <class Work>
double best_rate(const Clock& now_ms, Work work) {
  double best = 0.0;
  for (int i = 0; i < kTries; ++i) {
    const double start = now_ms();
    double took = 0.0, done = 0.0;
    while (took < kTry_ms) {
      work();
      ++done;
      took = now_ms() - start;
    }
    best = std::max(best, 1e3 * done / took);
  }
  return best;
}

/// [] bytes/s read and written by copies between two blocks of this size.
double copy_rate(std::size_t block, const Clock& now_ms) {
  if (block == 0) return 0.0;
  const std::vector<char> source(block, 'w');
  std::vector<char> target(block);
  // Small blocks are copied many times between two looks at the clock.
  const std::size_t times = std::max<std::size_t>(1, (std::size_t{4} << 20U) / block);
  const auto copy = [&] {
    for (std::size_t i = 0; i < times; ++i) {
      std::memcpy(target.data(), source.data(), block);
      keep(target.data());
    }
  };
  copy();  // its pages are there from now on
  return best_rate(now_ms, copy) * 2.0 * static_cast<double>(times * block);
}

/// Two numbers that are computed with at once, as every processor of this architecture can.
using Pair = double __attribute__((vector_size(16)));

double multiply_add_rate(const Clock& now_ms) {
  constexpr int kRounds = 10000;
  constexpr double kEachRound = 16.0;
  const Pair factor{0.999, 0.998}, addend{0.001, 0.002};
  // As many independent sums as stay in registers, so that none waits for the one before it.
  std::array<Pair, 8> sums{};
  const auto work = [&] {
    auto [a, b, c, d, e, f, g, h] = sums;
    for (int round = 0; round < kRounds; ++round) {
      a = a * factor + addend;
      b = b * factor + addend;
      c = c * factor + addend;
      d = d * factor + addend;
      e = e * factor + addend;
      f = f * factor + addend;
      g = g * factor + addend;
      h = h * factor + addend;
    }
    sums = {a, b, c, d, e, f, g, h};
    keep(sums.data());
  };
  keep(sums.data());
  return best_rate(now_ms, work) * kRounds * kEachRound;
}

/// A quarter of a cache each for source and target leaves room for what else is in it.
std::size_t quarter_of_cache(int name) {
  const long bytes = sysconf(name);
  return bytes > 0 ? to_index(bytes) / 4 : 0;
}

}  // namespace

MachineSpeed measure_machine(const Clock& now_ms) {
  return {copy_rate(quarter_of_cache(_SC_LEVEL1_DCACHE_SIZE), now_ms),
          copy_rate(quarter_of_cache(_SC_LEVEL2_CACHE_SIZE), now_ms),
          copy_rate(kMemoryBlock_bytes, now_ms), multiply_add_rate(now_ms)};
}

MachineSpeed better_of(const MachineSpeed& one, const MachineSpeed& other) {
  return {std::max(one.l1_bytes_per_s, other.l1_bytes_per_s),
          std::max(one.l2_bytes_per_s, other.l2_bytes_per_s),
          std::max(one.memory_bytes_per_s, other.memory_bytes_per_s),
          std::max(one.multiply_adds_per_s, other.multiply_adds_per_s)};
}

double floor_ms(double bytes, const MachineSpeed& speed) {
  return 1e3 * bytes / speed.memory_bytes_per_s;
}

}  // namespace weft::bench
