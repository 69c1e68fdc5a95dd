// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <stdexcept>
#include <weft/core/inline_vector.hpp>
#include <weft/core/name.hpp>

namespace weft {
namespace {

TEST(Name, IsATextOfOneOrTwoParts) {
  const Name whole("diag.", "residual_px");
  EXPECT_EQ(whole, "diag.residual_px");
  EXPECT_STREQ(whole.c_str(), "diag.residual_px");
  EXPECT_EQ(std::string(whole), std::string_view(whole));
  EXPECT_EQ(Name(), "");
  EXPECT_STREQ(Name().c_str(), "");
}

TEST(Name, HoldsWhatTheContractAllowsAndNoMore) {
  const std::string longest(Name::kLongest, 'x');
  EXPECT_EQ(Name(longest), longest);
  EXPECT_THROW(Name(longest + "x"), std::length_error);
  EXPECT_THROW(Name("diag.", longest), std::length_error);
}

TEST(InlineVector, KeepsItsElementsWhenItGrowsOutOfItsPlace) {
  InlineVector<int, 4> list;
  EXPECT_TRUE(list.empty());
  for (int i = 0; i < 20; ++i) {
    list.push_back(10 * i);
    ASSERT_EQ(list.size(), static_cast<std::size_t>(i + 1));
    for (int k = 0; k <= i; ++k) ASSERT_EQ(list.begin()[k], 10 * k) << "of " << i + 1;
  }
}

}  // namespace
}  // namespace weft
