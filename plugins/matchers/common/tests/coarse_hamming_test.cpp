// SPDX-License-Identifier: Apache-2.0
#include "common/distances/coarse_hamming.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <weft/core/index.hpp>

#include "common/tests/keypoints_of.hpp"

namespace weft::matchers {
namespace {

int by_definition(const Array<std::uint8_t>& a, std::int64_t i, const Array<std::uint8_t>& b,
                  std::int64_t j) {
  int bits = 0;
  for (std::int64_t k = 0; k < a.dim(1); ++k) {
    bits += std::popcount(static_cast<unsigned>(a(i, k) ^ b(j, k)));
  }
  return bits;
}

class CoarseHammingOnEachProcessor : public ::testing::TestWithParam<BitKernel> {};
INSTANTIATE_TEST_SUITE_P(Kernels, CoarseHammingOnEachProcessor, ::testing::ValuesIn(bit_kernels()),
                         [](const auto& instance) {
                           std::string name = instance.param.name;
                           std::erase_if(name, [](char c) { return c == ' ' || c == '-'; });
                           return name;
                         });

TEST_P(CoarseHammingOnEachProcessor, CountsDifferingBitsForAnyNumberOfBytes) {
  std::printf("seed 4\n");
  Rng rng(4);
  for (const int length : {1, 8, 32, 61, 300, 5000}) {
    const Array<std::uint8_t> a = random_bytes(30, length, rng), b = random_bytes(70, length, rng);
    CoarseHamming distances(GetParam());
    distances.load(a, b);
    distances.pack_trains();
    std::vector<std::int16_t> codes(to_index(kBlockQueries * distances.row_length()));
    CoarseDistances::Scratch scratch;
    distances.fill(std::array{29, 3}, scratch, codes.data());
    const std::array queries{29, 3};
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const int query = queries[i];
      const std::int16_t* row = codes.data() + i * to_index(distances.row_length());
      for (int j = 0; j < 70; ++j) {
        const int expected = by_definition(a, query, b, j);
        ASSERT_EQ(distances.distance(query, j), expected);
        ASSERT_LE(distances.lower(query, row[j]), expected);
        ASSERT_GE(distances.upper(query, row[j]), expected);
        ASSERT_EQ(distances.last_code(query, expected), row[j]);
        std::int16_t some = 0;
        distances.fill_some(query, std::array{j}, &some);
        ASSERT_EQ(some, row[j]);
        if (length < 5000) {
          ASSERT_EQ(row[j], expected);
        }
      }
      ASSERT_EQ(row[70], kBeyond);
    }
  }
}

}  // namespace
}  // namespace weft::matchers
