// SPDX-License-Identifier: Apache-2.0
#include "weft/geometry/object_box.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

namespace weft {
namespace {

Template with_mask(std::int64_t height, std::int64_t width) {
  Template templ;
  templ.texture = Array<std::uint8_t>({height, width}, 0);
  templ.mask = Array<std::uint8_t>({height, width}, 0);
  return templ;
}

TEST(ObjectBox, IsTheWholeTextureWhereAllOfItBelongsToTheObject) {
  Template templ = with_mask(3, 5);
  std::fill_n(templ.mask.data(), templ.mask.size(), 1);
  EXPECT_EQ(object_box(templ), (TextureBox{-0.5, 4.5, -0.5, 2.5}));
}

TEST(ObjectBox, ReachesToThePixelsThatBelongToTheObject) {
  Template templ = with_mask(40, 60);
  for (const auto& [y, x] : {std::pair(7, 30), {12, 11}, {20, 58}, {33, 31}}) templ.mask(y, x) = 1;
  const TextureBox box = object_box(templ);
  EXPECT_EQ(box, (TextureBox{10.5, 58.5, 6.5, 33.5}));
  EXPECT_EQ(box.width_px(), 48.0);
  EXPECT_EQ(box.height_px(), 27.0);
  EXPECT_TRUE(box.contains(10.5, 33.5));
  EXPECT_FALSE(box.contains(10.4, 20.0));
  EXPECT_EQ(box.grown(2.0), (TextureBox{8.5, 60.5, 4.5, 35.5}));
}

TEST(ObjectBox, FindsASinglePixelInEachCorner) {
  for (const auto& [y, x] : {std::pair(0, 0), {0, 8}, {6, 0}, {6, 8}}) {
    Template templ = with_mask(7, 9);
    templ.mask(y, x) = 1;
    EXPECT_EQ(object_box(templ), (TextureBox{x - 0.5, x + 0.5, y - 0.5, y + 0.5}));
  }
}

TEST(ObjectBox, IsTheWholeTextureWhereTheMaskSaysNothing) {
  EXPECT_EQ(object_box(with_mask(3, 5)), (TextureBox{-0.5, 4.5, -0.5, 2.5}));
  Template without = with_mask(3, 5);
  without.mask = {};
  EXPECT_EQ(object_box(without), (TextureBox{-0.5, 4.5, -0.5, 2.5}));
}

}  // namespace
}  // namespace weft
