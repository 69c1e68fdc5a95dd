// SPDX-License-Identifier: Apache-2.0
#include "common/distances/code_row.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

namespace weft::matchers {
namespace {

std::vector<std::int16_t> random_codes(int length, Rng& rng) {
  std::vector<std::int16_t> codes(to_index(length));
  for (std::int16_t& code : codes) code = static_cast<std::int16_t>(rng.below(kBeyond));
  return codes;
}

TEST(CodeRow, FindsTheFirstOfTheSmallestCodesWhateverIsHidden) {
  std::printf("seed 6\n");
  Rng rng(6);
  const std::vector<std::int16_t> given = random_codes(4 * kCodeBlock, rng);
  std::vector<std::int16_t> codes = given;
  CodeRow row;
  row.open(codes.data(), static_cast<int>(codes.size()));
  std::vector<std::int16_t> left = given;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const auto smallest = std::min_element(left.begin(), left.end());
    ASSERT_EQ(row.minimum(), *smallest);
    ASSERT_EQ(row.first_with(*smallest), smallest - left.begin());
    row.hide(static_cast<int>(smallest - left.begin()));
    *smallest = kBeyond;
  }
  EXPECT_EQ(row.minimum(), kBeyond);
  row.hide(0);  // once more
  row.show_all();
  EXPECT_EQ(codes, given);
  EXPECT_EQ(row.minimum(), *std::min_element(given.begin(), given.end()));
}

TEST(CodeRow, VisitsAllCodesUpToABoundInOrder) {
  Rng rng(7);
  std::vector<std::int16_t> codes = random_codes(3 * kCodeBlock, rng);
  CodeRow row;
  row.open(codes.data(), static_cast<int>(codes.size()));
  for (const int last : {-1, 0, 3000, 20'000, kBeyond - 1}) {
    std::vector<int> expected, visited;
    for (std::size_t i = 0; i < codes.size(); ++i) {
      if (codes[i] <= last) expected.push_back(static_cast<int>(i));
    }
    row.for_each_up_to(last, [&](int position, int code) {
      EXPECT_EQ(code, codes[to_index(position)]);
      visited.push_back(position);
    });
    EXPECT_EQ(visited, expected) << last;
  }
}

}  // namespace
}  // namespace weft::matchers
