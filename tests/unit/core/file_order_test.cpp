// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <vector>
#include <weft/core/file_order.hpp>
#include <weft/core/rng.hpp>

namespace weft {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> sorted(std::vector<std::string> names) {
  std::sort(names.begin(), names.end(), natural_less);
  return names;
}

TEST(FileOrder, ComparesDigitsAsNumbers) {
  EXPECT_THAT(sorted({"img_10", "img_2", "img_1", "img_11"}),
              ElementsAre("img_1", "img_2", "img_10", "img_11"));
  EXPECT_THAT(sorted({"b1", "a10", "a9"}), ElementsAre("a9", "a10", "b1"));
  EXPECT_THAT(sorted({"2/10.png", "10/1.png", "2/9.png"}),
              ElementsAre("2/9.png", "2/10.png", "10/1.png"));
  EXPECT_THAT(sorted({"20240101123456789012345678", "9", "20240101123456789012345677"}),
              ElementsAre("9", "20240101123456789012345677", "20240101123456789012345678"));
}

TEST(FileOrder, KeepsTheBytewiseOrderOfNumbersOfOneLength) {
  EXPECT_THAT(sorted({"f0010.png", "f0002.png", "F0003.png"}),
              ElementsAre("F0003.png", "f0002.png", "f0010.png"));
}

TEST(FileOrder, OrdersNamesThatDifferInLeadingZerosAlone) {
  EXPECT_THAT(sorted({"1", "01", "001"}), ElementsAre("001", "01", "1"));
  EXPECT_TRUE(natural_less("a", "a1"));
  EXPECT_FALSE(natural_less("a", "a"));
}

TEST(FileOrder, IsAnOrder) {
  constexpr std::uint64_t kSeed = 11;
  SCOPED_TRACE(kSeed);
  Rng rng(kSeed);
  std::vector<std::string> names;
  for (int i = 0; i < 60; ++i) {
    std::string name;
    for (std::uint64_t k = rng.below(6); k > 0; --k) name += "012ab_"[rng.below(6)];
    names.push_back(name);
  }
  for (const std::string& a : names) {
    for (const std::string& b : names) {
      EXPECT_FALSE(natural_less(a, b) && natural_less(b, a)) << a << " " << b;
      EXPECT_TRUE(a == b || natural_less(a, b) || natural_less(b, a)) << a << " " << b;
      for (const std::string& c : names) {
        if (natural_less(a, b) && natural_less(b, c)) {
          EXPECT_TRUE(natural_less(a, c)) << a << " " << b << " " << c;
        }
      }
    }
  }
}

TEST(FileOrder, HintsAtAWildcardForNumberingsOfOtherPrograms) {
  EXPECT_THAT(numbering_hint("frames/img_%04d.png"), HasSubstr("'frames/img_*.png'"));
  EXPECT_THAT(numbering_hint("img_%d.png"), HasSubstr("'img_*.png'"));
  EXPECT_THAT(numbering_hint("img_####.png"), HasSubstr("'img_*.png'"));
  EXPECT_THAT(numbering_hint("img_{:04d}.png"), HasSubstr("'img_*.png'"));
  EXPECT_THAT(numbering_hint("img_*.png"), IsEmpty());
  EXPECT_THAT(numbering_hint("50%/#1.png"), IsEmpty());
}

}  // namespace
}  // namespace weft
