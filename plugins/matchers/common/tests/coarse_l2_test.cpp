// SPDX-License-Identifier: Apache-2.0
#include "common/distances/coarse_l2.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <weft/core/index.hpp>

#include "common/tests/keypoints_of.hpp"

namespace weft::matchers {
namespace {

double by_definition(const Array<float>& a, std::int64_t i, const Array<float>& b, std::int64_t j,
                     bool root) {
  const auto value = [root](const Array<float>& d, std::int64_t row, std::int64_t k) {
    if (!root) return static_cast<double>(d(row, k));
    double sum = 0.0;
    for (std::int64_t n = 0; n < d.dim(1); ++n) sum += static_cast<double>(d(row, n));
    return sum > 0.0 ? std::sqrt(static_cast<double>(d(row, k)) / sum) : 0.0;
  };
  double sum = 0.0;
  for (std::int64_t k = 0; k < a.dim(1); ++k) {
    const double difference = value(a, i, k) - value(b, j, k);
    sum += difference * difference;
  }
  return std::sqrt(sum);
}

/// The code of each pair, by fill() and by fill_some(), which must agree.
std::vector<std::int16_t> codes_of(CoarseL2& distances) {
  distances.pack_trains();
  const int length = distances.row_length();
  CoarseDistances::Scratch scratch;
  std::vector<std::int16_t> block(to_index(kBlockQueries * length)), codes;
  std::vector<int> all(to_index(distances.trains()));
  std::iota(all.begin(), all.end(), 0);
  std::vector<std::int16_t> some(all.size());
  for (int query = 0; query < distances.queries(); ++query) {
    distances.fill(std::array{query}, scratch, block.data());
    distances.fill_some(query, all, some.data());
    for (int j = 0; j < length; ++j) {
      const std::int16_t code = block[to_index(j)];
      EXPECT_EQ(code, j < distances.trains() ? some[to_index(j)] : kBeyond) << query << " " << j;
    }
    codes.insert(codes.end(), some.begin(), some.end());
  }
  return codes;
}

void expect_bounds(const CoarseL2& distances, const std::vector<std::int16_t>& codes) {
  for (int i = 0; i < distances.queries(); ++i) {
    for (int j = 0; j < distances.trains(); ++j) {
      const double distance = distances.distance(i, j);
      const int code = codes[to_index(i * distances.trains() + j)];
      ASSERT_LE(distances.lower(i, code), distance) << i << " " << j;
      ASSERT_GE(distances.upper(i, code), distance) << i << " " << j;
      ASSERT_GE(distances.last_code(i, distance), code) << i << " " << j;
      ASSERT_LE(std::abs(distances.fine_distance(i, j) - distance), distances.fine_slack(i));
    }
  }
}

Array<float> gaussian(std::int64_t count, std::int64_t length, double mean, double sigma,
                      Rng& rng) {
  Array<float> numbers({count, length}, 0.0F);
  for (std::int64_t i = 0; i < numbers.size(); ++i) {
    numbers.data()[i] = static_cast<float>(mean + sigma * rng.normal());
  }
  return numbers;
}

class CoarseL2OnEachProcessor : public ::testing::TestWithParam<ByteKernels> {};
INSTANTIATE_TEST_SUITE_P(Kernels, CoarseL2OnEachProcessor, ::testing::ValuesIn(byte_kernels()),
                         [](const auto& instance) {
                           std::string name = instance.param.name;
                           std::erase_if(name, [](char c) { return c == ' ' || c == '-'; });
                           return name;
                         });

TEST_P(CoarseL2OnEachProcessor, GivesTheCodesOfThePlainOneAndBoundsThatHold) {
  std::printf("seed 1\n");
  Rng rng(1);
  for (const auto& [queries, trains, length] :
       {std::array{1, 2, 1}, std::array{25, 63, 7}, std::array{30, 64, 128}, std::array{3, 65, 61},
        std::array{7, 200, 128}, std::array{2, 3, 400}}) {
    const std::array sets{std::pair(random_descriptors(queries, length, rng),
                                    random_descriptors(trains, length, rng)),
                          std::pair(gaussian(queries, length, 0.0, 0.1, rng),
                                    gaussian(trains, length, 0.0, 0.1, rng)),
                          std::pair(gaussian(queries, length, 5e6, 1.0, rng),
                                    gaussian(trains, length, -3.0, 1, rng))};
    for (const auto& [a, b] : sets) {
      CoarseL2 distances(GetParam()), plain(byte_kernels().back());
      distances.load(a, b, false);
      plain.load(a, b, false);
      const std::vector<std::int16_t> codes = codes_of(distances);
      EXPECT_EQ(codes, codes_of(plain));
      expect_bounds(distances, codes);
    }
    CoarseL2 roots(GetParam());
    roots.load(sets[0].first, sets[0].second, true);
    expect_bounds(roots, codes_of(roots));
  }
}

TEST_P(CoarseL2OnEachProcessor, HoldsItsBoundsForTheLargestSumsOfProducts) {
  // All of the norm in one number, in a pair of neighbours, in equal parts, and nothing at all.
  Array<float> rows({5, 128}, 0.0F);
  rows(0, 3) = 255.0F;
  rows(1, 2) = rows(1, 3) = 255.0F;
  for (int k = 0; k < 128; ++k) rows(2, k) = 255.0F;
  for (int k = 0; k < 4; ++k) rows(4, k) = 255.0F;
  CoarseL2 distances(GetParam());
  for (const bool root : {false, true}) {
    distances.load(rows, rows, root);
    expect_bounds(distances, codes_of(distances));
  }
}

TEST_P(CoarseL2OnEachProcessor, HoldsItsBoundsWhereNumbersOverflowOrVanish) {
  for (const float unit : {3e38F, 1e-20F, 1e-42F}) {
    Array<float> rows({3, 8}, 0.0F);
    rows(0, 0) = unit;
    rows(1, 1) = unit;
    rows(2, 1) = 0.5F * unit;
    CoarseL2 distances(GetParam());
    distances.load(rows, rows, false);
    expect_bounds(distances, codes_of(distances));
    distances.load(rows, rows, true);
    expect_bounds(distances, codes_of(distances));
    EXPECT_NEAR(distances.distance(0, 1), std::sqrt(2.0), 1e-6);
  }
  Array<float> both({2, 8}, 0.0F);
  both(0, 0) = 3e38F;
  both(1, 0) = -3e38F;
  CoarseL2 distances(GetParam());
  distances.load(both, both, false);
  expect_bounds(distances, codes_of(distances));
}

TEST_P(CoarseL2OnEachProcessor, HoldsItsBoundsForDescriptorsOfAHundredThousandNumbers) {
  Rng rng(2);
  const Array<float> rows = random_descriptors(3, 100'000, rng);
  CoarseL2 distances(GetParam());
  distances.load(rows, rows, false);
  expect_bounds(distances, codes_of(distances));
}

TEST(CoarseL2, DistancesAreThoseOfTheDefinition) {
  std::printf("seed 3\n");
  Rng rng(3);
  for (const int length : {1, 7, 61, 128}) {
    const Array<float> a = random_descriptors(20, length, rng);
    const Array<float> b = random_descriptors(30, length, rng);
    CoarseL2 distances;
    for (const bool root : {false, true}) {
      distances.load(a, b, root);
      for (int i = 0; i < 20; ++i) {
        for (int j = 0; j < 30; ++j) {
          const double expected = by_definition(a, i, b, j, root);
          if (root) {
            ASSERT_NEAR(distances.distance(i, j), expected, 1e-6);
          } else {
            ASSERT_EQ(distances.distance(i, j), expected) << "whole numbers are exact";
          }
        }
      }
    }
  }
}

TEST(CoarseL2, KeepsWhatItMadeOfASideOfTheSameRevisionOnly) {
  std::printf("seed 5\n");
  Rng rng(5);
  const Array<float> templ = random_descriptors(20, 128, rng),
                     other = random_descriptors(20, 128, rng);
  const Array<float> negative = gaussian(30, 128, 0.0, 100.0, rng);
  CoarseL2 warm;
  std::uint64_t image_revision = 100;
  for (const bool root : {true, false}) {
    for (const auto& [rows, revision] :
         {std::pair(&templ, 7), std::pair(&templ, 7), std::pair(&other, 8), std::pair(&templ, 0),
          std::pair(&other, 0), std::pair(&templ, 7)}) {
      const Array<float> image = random_descriptors(30, 128, rng);
      for (const Array<float>* trains : {&image, &negative}) {
        if (root && trains == &negative) continue;
        Array<float> moved({20, 128}, 0.0F);  // the same content elsewhere in memory
        std::copy_n(rows->data(), rows->size(), moved.data());
        CoarseL2 fresh;
        fresh.load(moved, *trains, root);
        warm.load(moved, *trains, root, static_cast<std::uint64_t>(revision), ++image_revision);
        EXPECT_EQ(codes_of(warm), codes_of(fresh));
        EXPECT_EQ(warm.distance(3, 5), fresh.distance(3, 5));
        EXPECT_EQ(warm.fine_distance(3, 5), fresh.fine_distance(3, 5));
      }
    }
  }
}

TEST(CoarseL2, TheBitsAreThoseOfOneThreadForAnyNumberOfThem) {
  std::printf("seed 6\n");
  Rng rng(6);
  for (const int length : {128, 37}) {
    for (const bool root : {true, false}) {
      const Array<float> a = random_descriptors(700, length, rng),
                         b = random_descriptors(301, length, rng);
      CoarseL2 alone, shared;
      alone.load(a, b, root);
      for (const int threads : {2, 4, 1, 3}) {
        shared.load(a, b, root, 0, 0, threads);
        EXPECT_EQ(codes_of(shared), codes_of(alone)) << threads << " threads";
        for (int query = 0; query < 700; query += 7) {
          EXPECT_EQ(shared.fine_distance(query, 13), alone.fine_distance(query, 13));
          EXPECT_EQ(shared.distance(query, 300), alone.distance(query, 300));
          EXPECT_EQ(shared.lower(query, 500), alone.lower(query, 500));
          EXPECT_EQ(shared.fine_slack(query), alone.fine_slack(query));
        }
      }
    }
  }
}

TEST(CoarseL2, SwappingSidesSwapsThem) {
  Rng rng(4);
  CoarseL2 distances;
  const Array<float> a = random_descriptors(5, 16, rng), b = random_descriptors(9, 16, rng);
  distances.load(a, b, true);
  const double distance = distances.distance(2, 7);
  distances.swap_sides();
  EXPECT_EQ(distances.queries(), 9);
  EXPECT_EQ(distances.trains(), 5);
  EXPECT_EQ(distances.distance(7, 2), distance);
  expect_bounds(distances, codes_of(distances));
}

TEST(CoarseL2, ADescriptorThatIsZeroHasNoRoot) {
  const Array<float> zero({2, 8}, 0.0F);
  CoarseL2 distances;
  distances.load(zero, zero, true);
  EXPECT_EQ(distances.distance(0, 1), 0.0);
}

}  // namespace
}  // namespace weft::matchers
