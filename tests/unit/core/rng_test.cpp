// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numeric>
#include <set>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

namespace weft {
namespace {

using ::testing::ElementsAre;

// The golden values come from a separate implementation of PCG32 that gives the numbers published
// with its reference code (0xa15c02b7, 0x7b47f409 ... for state 42, stream 54). They never change:
// results of earlier runs depend on them.

std::vector<std::uint32_t> first_draws(std::uint64_t seed, int count) {
  Rng rng(seed);
  std::vector<std::uint32_t> draws;
  for (int i = 0; i < count; ++i) draws.push_back(rng.next_u32());
  return draws;
}

TEST(Rng, GivesTheGoldenWords) {
  EXPECT_THAT(first_draws(0, 4), ElementsAre(0xe823a24eU, 0x7a7ecbd9U, 0x89fd6c06U, 0xae646aa8U));
  EXPECT_THAT(first_draws(42, 4), ElementsAre(0xc2f57bd6U, 0x6b07c4a9U, 0x72b7b29bU, 0x44215383U));
  EXPECT_THAT(first_draws(~std::uint64_t{0}, 4),
              ElementsAre(0xd9313036U, 0xcd4b6992U, 0x7b8ec69eU, 0x999dd010U));
}

TEST(Rng, GivesTheGoldenUniformNumbers) {
  Rng rng(42);
  EXPECT_EQ(rng.uniform(), 0x1.85eaf79ac1f12p-1);
  EXPECT_EQ(rng.uniform(), 0x1.cadeca2210a9cp-2);
  EXPECT_EQ(rng.uniform(), 0x1.eb5ebd5a2fad8p-1);
  EXPECT_EQ(rng.uniform(), 0x1.978e62757bf1fp-1);
}

TEST(Rng, GivesTheGoldenNormalNumbers) {
  Rng rng(42);
  EXPECT_DOUBLE_EQ(rng.normal(), 1.555445754582442);
  EXPECT_DOUBLE_EQ(rng.normal(), -0.3085489198586646);
  EXPECT_DOUBLE_EQ(rng.normal(), -0.17585162770524587);
  EXPECT_DOUBLE_EQ(rng.normal(), 1.8540782475418827);
  EXPECT_DOUBLE_EQ(rng.normal(), 0.3134504235811569);
}

TEST(Rng, GivesTheGoldenIntegersBelowABound) {
  Rng rng(42);
  std::vector<std::uint32_t> digits;
  for (int i = 0; i < 12; ++i) digits.push_back(rng.below(10));
  EXPECT_THAT(digits, ElementsAre(6, 9, 5, 5, 7, 6, 0, 1, 4, 3, 5, 5));
  Rng large(42);  // three words in ten are rejected and replaced
  EXPECT_EQ(large.below(3000000000U), 270867926U);
  EXPECT_EQ(large.below(3000000000U), 1795671209U);
  EXPECT_EQ(large.below(3000000000U), 1924641435U);
  EXPECT_EQ(large.below(3000000000U), 1121910957U);
}

TEST(Rng, GivesTheGoldenShuffleAndSample) {
  Rng rng(42);
  std::vector<int> values(10);
  std::iota(values.begin(), values.end(), 0);
  rng.shuffle(values);
  EXPECT_THAT(values, ElementsAre(4, 5, 9, 0, 1, 7, 8, 3, 2, 6));
  Rng other(42);
  EXPECT_THAT(other.sample(20, 6), ElementsAre(6, 1, 5, 12, 17, 0));
}

TEST(Rng, UniformNumbersFillTheirIntervalEvenly) {
  std::cout << "seed 5\n";
  Rng rng(5);
  constexpr int kDraws = 100000;
  std::vector<int> bins(10, 0);
  for (int i = 0; i < kDraws; ++i) {
    const double draw = rng.uniform(-2.0, 3.0);
    ASSERT_GE(draw, -2.0);
    ASSERT_LT(draw, 3.0);
    ++bins[to_index((draw + 2.0) * 2.0)];
  }
  for (const int count : bins) EXPECT_NEAR(count, kDraws / 10, 500);  // five sigma
}

TEST(Rng, IntegersBelowABoundAreEquallyLikely) {
  std::cout << "seed 6\n";
  Rng rng(6);
  std::vector<int> counts(7, 0);
  for (int i = 0; i < 70000; ++i) ++counts[rng.below(7)];
  for (const int count : counts) EXPECT_NEAR(count, 10000, 500);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(rng.below(1), 0U);
}

TEST(Rng, NormalNumbersHaveTheMomentsOfTheNormalDistribution) {
  std::cout << "seed 7\n";
  Rng rng(7);
  constexpr int kDraws = 200000;
  double sum = 0.0, squares = 0.0, fourth = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double draw = rng.normal();
    sum += draw;
    squares += draw * draw;
    fourth += std::pow(draw, 4);
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.012);
  EXPECT_NEAR(squares / kDraws, 1.0, 0.016);
  EXPECT_NEAR(fourth / kDraws, 3.0, 0.11);
}

TEST(Rng, ShuffleKeepsAllValues) {
  std::cout << "seed 8\n";
  Rng rng(8);
  for (std::size_t size = 0; size < 30; ++size) {
    std::vector<std::size_t> values(size), sorted(size);
    std::iota(values.begin(), values.end(), 0U);
    rng.shuffle(values);
    sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t i = 0; i < size; ++i) EXPECT_EQ(sorted[i], i);
  }
}

TEST(Rng, SamplesAreDistinctAndInRange) {
  std::cout << "seed 9\n";
  Rng rng(9);
  for (int population = 0; population < 20; ++population) {
    const int count = static_cast<int>(rng.below(static_cast<std::uint32_t>(population) + 1));
    const std::vector<int> chosen = rng.sample(population, count);
    EXPECT_EQ(chosen.size(), to_index(count));
    EXPECT_EQ(std::set<int>(chosen.begin(), chosen.end()).size(), chosen.size());
    for (const int index : chosen) EXPECT_TRUE(index >= 0 && index < population);
  }
}

}  // namespace
}  // namespace weft
