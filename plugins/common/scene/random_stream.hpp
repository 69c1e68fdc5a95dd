// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <weft/core/rng.hpp>

namespace weft::scene {

/// A separate generator for each purpose and frame of one seed, so that frames can be made in any
/// order. The three numbers are mixed by SplitMix64 (Steele, Lea and Flood 2014).
inline Rng random_stream(std::uint64_t seed, std::uint64_t purpose, std::uint64_t frame = 0) {
  std::uint64_t mixed = seed;
  for (const std::uint64_t part : {purpose, frame}) {
    mixed += 0x9E3779B97F4A7C15ULL * (part + 1);
    mixed = (mixed ^ (mixed >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    mixed = (mixed ^ (mixed >> 27U)) * 0x94D049BB133111EBULL;
    mixed ^= mixed >> 31U;
  }
  return Rng(mixed);
}

}  // namespace weft::scene
