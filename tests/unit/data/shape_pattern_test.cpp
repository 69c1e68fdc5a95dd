// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/layout.hpp>

namespace weft {
namespace {

/// A dense f64 array of this shape; the data are never looked at.
weft_array dense(const std::vector<std::int64_t>& shape) {
  static double somewhere = 0.0;
  weft_array array{};
  array.dtype = WEFT_F64;
  array.ndim = static_cast<std::int32_t>(shape.size());
  array.data = &somewhere;
  std::int64_t stride = 8;
  for (int axis = array.ndim - 1; axis >= 0; --axis) {
    array.shape[axis] = shape[to_index(axis)];
    array.stride[axis] = stride;
    stride *= array.shape[axis];
  }
  return array;
}

std::string match(const char* pattern, const std::vector<std::int64_t>& shape) {
  return ShapePattern().match(pattern, dense(shape));
}

TEST(ShapePattern, NumbersAreLengths) {
  EXPECT_EQ(match("2", {2}), "");
  EXPECT_EQ(match("2,3", {2, 3}), "");
  EXPECT_EQ(match("2", {3}), "has length 3 on axis 0 where 2 is expected");
  EXPECT_EQ(match("N,3", {5, 2}), "has length 2 on axis 1 where 3 is expected");
}

TEST(ShapePattern, NothingIsAScalar) {
  EXPECT_EQ(match("", {}), "");
  EXPECT_EQ(match("", {1}), "has 1 axis where a scalar is expected");
  EXPECT_EQ(match("N,2", {}), "has 0 axes where [N,2] is expected");
}

TEST(ShapePattern, ALetterIsOneLengthThroughoutARecord) {
  ShapePattern lengths;
  EXPECT_EQ(lengths.match("N,2", dense({7, 2})), "");
  EXPECT_EQ(lengths.match("N", dense({7})), "");
  EXPECT_EQ(lengths.match("K,N", dense({3, 7})), "");
  EXPECT_EQ(lengths.match("N", dense({6})), "has length 6 on axis 0 where N = 7 is expected");
  EXPECT_EQ(lengths.match("K", dense({7})), "has length 7 on axis 0 where K = 3 is expected");
}

TEST(ShapePattern, AnEmptyArrayFixesItsLetterToo) {
  ShapePattern lengths;
  EXPECT_EQ(lengths.match("N,2", dense({0, 2})), "");
  EXPECT_EQ(lengths.match("N", dense({1})), "has length 1 on axis 0 where N = 0 is expected");
}

TEST(ShapePattern, AStarIsAnyLength) {
  ShapePattern lengths;
  EXPECT_EQ(lengths.match("*", dense({3})), "");
  EXPECT_EQ(lengths.match("*", dense({0})), "");
  EXPECT_NE(lengths.match("*", dense({3, 3})), "");
}

TEST(ShapePattern, AQuestionMarkIsAnOptionalAxisOfThree) {
  EXPECT_EQ(match("H,W,?", {4, 5}), "");
  EXPECT_EQ(match("H,W,?", {4, 5, 3}), "");
  EXPECT_EQ(match("H,W,?", {4, 5, 4}), "has 3 axes where [H,W,?] is expected");
  EXPECT_NE(match("H,W,?", {4, 5, 3, 3}), "");
  EXPECT_NE(match("H,W,?", {4}), "");
  EXPECT_NE(match("H,W", {4, 5, 3}), "");
}

TEST(ShapePattern, NegativeLengthsAreNamed) {
  EXPECT_EQ(match("N", {-1}), "has a negative length");
  EXPECT_EQ(match("N,2", {3, -2}), "has a negative length");
}

TEST(ShapePattern, OnlyTheFirstOfSeveralAxesMayBePadded) {
  weft_array rows = dense({4, 3});
  rows.stride[0] = 64;
  EXPECT_EQ(ShapePattern().match("N,3", rows), "");
  rows.stride[0] = -24;
  EXPECT_EQ(ShapePattern().match("N,3", rows), "");
  rows.stride[0] = 30;  // no multiple of an element
  EXPECT_EQ(ShapePattern().match("N,3", rows), "is not laid out in C order");
  weft_array columns = dense({4, 3});
  columns.stride[1] = 16;
  EXPECT_EQ(ShapePattern().match("N,3", columns), "is not laid out in C order");
  weft_array list = dense({4});
  list.stride[0] = 16;
  EXPECT_EQ(ShapePattern().match("N", list), "is not laid out in C order");
}

TEST(ShapePattern, WhatCannotBeReadIsNamed) {
  weft_array array = dense({4});
  array.memory = WEFT_DEVICE;
  EXPECT_EQ(ShapePattern().match("N", array), "has no handle");
  array = dense({4});
  array.data = nullptr;
  EXPECT_EQ(ShapePattern().match("N", array), "has no data");
  array = dense({4});
  array.dtype = 99;
  EXPECT_EQ(ShapePattern().match("N", array), "has elements of an unknown type");
}

}  // namespace
}  // namespace weft
