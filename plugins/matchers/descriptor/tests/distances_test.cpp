// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <weft/core/index.hpp>

#include "common/tests/keypoints_of.hpp"
#include "hamming_distances.hpp"
#include "l2_distances.hpp"
#include "nearest_search.hpp"

namespace weft::descriptor {
namespace {

using matchers::random_bytes;
using matchers::random_descriptors;

double squared_distance(const float* a, const float* b, std::int64_t length) {
  double sum = 0.0;
  for (std::int64_t k = 0; k < length; ++k) {
    const double difference = static_cast<double>(a[k]) - static_cast<double>(b[k]);
    sum += difference * difference;
  }
  return sum;
}

std::vector<float> block_of(const DistanceRows& distances, int first) {
  std::vector<float> rows(to_index(kBlockRows * distances.row_length()), -1.0F);
  distances.fill(first, rows.data());
  return rows;
}

class L2Blocks : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(WideOrNot, L2Blocks, ::testing::Bool());

TEST_P(L2Blocks, AreThoseOfTheDefinitionForAnyNumberAndLength) {
  Rng rng(1);
  for (const auto& [queries, trains, length] :
       {std::array{1, 2, 1}, std::array{25, 63, 7}, std::array{48, 64, 128}, std::array{50, 65, 61},
        std::array{7, 200, 128}}) {
    const Array<float> a = random_descriptors(queries, length, rng);
    const Array<float> b = random_descriptors(trains, length, rng);
    L2Distances distances(GetParam());
    distances.load(a, b, false);
    ASSERT_EQ(distances.row_length() % kRowMultiple, 0);
    for (int first = 0; first < queries; first += kBlockRows) {
      const std::vector<float> rows = block_of(distances, first);
      for (int i = first; i < std::min(first + kBlockRows, queries); ++i) {
        const float* row = rows.data() + (i - first) * distances.row_length();
        for (int j = 0; j < trains; ++j) {
          const double expected = squared_distance(a.row(i), b.row(j), length);
          ASSERT_NEAR(row[j], expected, 1e-5 * (1.0 + expected)) << i << " " << j;
          ASSERT_DOUBLE_EQ(distances.distance(i, j), std::sqrt(expected));
        }
        for (int j = trains; j < distances.row_length(); ++j) ASSERT_TRUE(std::isinf(row[j]));
      }
    }
  }
}

TEST_P(L2Blocks, DoNotDependOnTheOrderOfTheDescriptors) {
  Rng rng(2);
  constexpr int kQueries = 40, kTrains = 100;
  const Array<float> a = random_descriptors(kQueries, 128, rng);
  const Array<float> b = random_descriptors(kTrains, 128, rng);
  Array<float> reversed({kTrains, 128});
  for (int j = 0; j < kTrains; ++j) std::copy_n(b.row(kTrains - 1 - j), 128, reversed.row(j));
  L2Distances straight(GetParam()), backward(GetParam());
  straight.load(a, b, true);
  backward.load(a, reversed, true);
  const std::vector<float> x = block_of(straight, 24), y = block_of(backward, 24);
  for (int i = 0; i < kQueries - 24; ++i) {
    for (int j = 0; j < kTrains; ++j) {
      const int row = i * straight.row_length();
      ASSERT_EQ(x[to_index(row + j)], y[to_index(row + kTrains - 1 - j)]);
    }
  }
}

TEST(L2Distances, RootsOfDescriptorsHaveNormOne) {
  Rng rng(3);
  const Array<float> a = random_descriptors(50, 128, rng);
  L2Distances distances;
  distances.load(a, a, true);
  for (int i = 0; i < 50; ++i) {
    double norm = 0.0;
    for (int k = 0; k < 128; ++k) norm += std::pow(static_cast<double>(distances.query(i)[k]), 2);
    EXPECT_NEAR(std::sqrt(norm), 1.0, 1e-5);
    EXPECT_EQ(distances.distance(i, i), 0.0);
  }
}

TEST(L2Distances, TheRootOfAnEmptyDescriptorIsEmpty) {
  const Array<float> zero({1, 8});
  L2Distances distances;
  distances.load(zero, zero, true);
  EXPECT_EQ(distances.query(0)[3], 0.0F);
}

TEST(HammingDistances, CountDifferingBitsForAnyNumberOfBytes) {
  Rng rng(4);
  for (const int length : {1, 8, 32, 61}) {
    const Array<std::uint8_t> a = random_bytes(30, length, rng), b = random_bytes(70, length, rng);
    HammingDistances distances;
    distances.load(a, b);
    const std::vector<float> rows = block_of(distances, 24);
    for (int i = 24; i < 30; ++i) {
      const float* row = rows.data() + (i - 24) * distances.row_length();
      for (int j = 0; j < 70; ++j) {
        int expected = 0;
        for (int k = 0; k < length; ++k) {
          expected += std::popcount(static_cast<unsigned>(a(i, k) ^ b(j, k)));
        }
        ASSERT_EQ(row[j], static_cast<float>(expected));
        ASSERT_EQ(distances.distance(i, j), expected);
      }
      ASSERT_TRUE(std::isinf(row[70]));
    }
  }
}

TEST(NearestSearch, FindsTheSameAsAScanOfAllPairs) {
  Rng rng(5);
  constexpr int kQueries = 60, kTrains = 300;
  const Array<std::uint8_t> a = random_bytes(kQueries, 3, rng);  // few bits: many ties
  const Array<std::uint8_t> b = random_bytes(kTrains, 3, rng);
  Array<double> places({kTrains, 2});
  for (int j = 0; j < kTrains; ++j) {
    places(j, 0) = rng.uniform(0.0, 40.0);
    places(j, 1) = rng.uniform(0.0, 40.0);
  }
  HammingDistances distances;
  distances.load(a, b);
  for (const double elsewhere_px : {0.0, 5.0}) {
    NearestSearch search;
    ASSERT_TRUE(search.run(distances, places, {elsewhere_px, true}, [] { return false; }));
    for (int i = 0; i < kQueries; ++i) {
      int best = 0, second = -1;
      for (int j = 1; j < kTrains; ++j) {
        if (distances.distance(i, j) < distances.distance(i, best)) best = j;
      }
      for (int j = 0; j < kTrains; ++j) {
        const double apart =
            std::hypot(places(j, 0) - places(best, 0), places(j, 1) - places(best, 1));
        if (j == best || (elsewhere_px > 0.0 && apart <= elsewhere_px)) continue;
        if (second < 0 || distances.distance(i, j) < distances.distance(i, second)) second = j;
      }
      const Nearest found = search.nearest()[to_index(i)];
      EXPECT_EQ(found.best, best);
      EXPECT_EQ(found.second, second);
    }
    for (int j = 0; j < kTrains; ++j) {
      int best = 0;
      for (int i = 1; i < kQueries; ++i) {
        if (distances.distance(i, j) < distances.distance(best, j)) best = i;
      }
      EXPECT_EQ(search.best_query(j), best);
    }
  }
}

TEST(NearestSearch, StopsWhenCancelled) {
  const Array<std::uint8_t> bytes({100, 4});
  HammingDistances distances;
  distances.load(bytes, bytes);
  NearestSearch search;
  int asked = 0;
  EXPECT_FALSE(
      search.run(distances, Array<double>({100, 2}), {0.0, false}, [&] { return ++asked == 2; }));
  EXPECT_EQ(asked, 2);
}

}  // namespace
}  // namespace weft::descriptor
