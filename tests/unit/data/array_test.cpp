// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <weft/data/array.hpp>
#include <weft/data/matrix.hpp>

namespace weft {
namespace {

TEST(Array, IsAbsentByDefault) {
  const Array<double> absent;
  EXPECT_FALSE(absent.present());
  EXPECT_EQ(absent.rows(), 0);
  EXPECT_EQ(absent.size(), 0);
}

TEST(Array, IsAlignedAndFilledWhenAsked) {
  for (int i = 0; i < 50; ++i) {
    std::free(std::malloc(64));  // so that reused memory is likely
    Array<float> array({3, 5}, 2.5F);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.data()) % 64, 0U);
    EXPECT_EQ(array.size(), 15);
    for (std::int64_t k = 0; k < 15; ++k) EXPECT_EQ(array.data()[k], 2.5F);
    for (std::int64_t k = 0; k < 15; ++k) array.data()[k] = 7.0F;
  }
}

TEST(Array, AScalarHasNoAxes) {
  Array<double> scalar({}, -1.5);
  EXPECT_EQ(scalar.ndim(), 0);
  EXPECT_EQ(*scalar.data(), -1.5);
  EXPECT_EQ(*make_scalar(3.5).data(), 3.5);
}

TEST(Array, UnwrittenElementsAreNanWhereTheyAreMarked) {
  const Array<double> numbers({4, 2});
  const Array<std::int32_t> indices({3});
  if (!kMarksUnwritten) GTEST_SKIP() << "not in this build: it leaves memory as it finds it";
  for (std::int64_t i = 0; i < 8; ++i) EXPECT_TRUE(std::isnan(numbers.data()[i]));
  for (std::int64_t i = 0; i < 3; ++i) EXPECT_EQ(indices(i), -1);
}

TEST(Array, CopiesShareTheirMemory) {
  Array<int> one({2}, 0);
  Array<int> two = one;
  two(1) = 9;
  EXPECT_EQ(one(1), 9);
}

TEST(Array, EmptyIsPresent) {
  const Array<double> empty({0, 3}, 0.0);
  EXPECT_TRUE(empty.present());
  EXPECT_EQ(empty.rows(), 0);
  EXPECT_EQ(empty.size(), 0);
  EXPECT_EQ(empty.matrix<3>().rows(), 0);
}

TEST(Array, IllegalShapesThrow) {
  EXPECT_THROW(Array<double>({-1}, 0.0), std::length_error);
  EXPECT_THROW(Array<double>({-2, -3}, 0.0), std::length_error);
  EXPECT_THROW(Array<double>({1, 1, 1, 1, 1, 1, 1}, 0.0), std::length_error);
}

TEST(Array, IsMadeFromEigenInRowOrder) {
  Eigen::Matrix<float, 2, 3> matrix;
  matrix << 1, 2, 3, 4, 5, 6;
  const auto array = make_array<double>(matrix);
  EXPECT_EQ(array.ndim(), 2);
  EXPECT_EQ(array.dim(0), 2);
  EXPECT_EQ(array.dim(1), 3);
  for (int k = 0; k < 6; ++k) EXPECT_EQ(array.data()[k], k + 1.0);
  const auto list = make_array<std::int32_t>(Eigen::Vector3i(7, 8, 9));
  EXPECT_EQ(list.ndim(), 1);
  EXPECT_EQ(list(2), 9);
  EXPECT_EQ(make_array<double>(array.matrix<3>() * 2.0)(1, 2), 12.0);
}

TEST(Array, WritesThroughEigen) {
  Array<double> array({2, 3}, 0.0);
  array.matrix<3>().row(1) = Eigen::RowVector3d(1, 2, 3);
  EXPECT_EQ(array(1, 2), 3.0);
  EXPECT_EQ(array(0, 2), 0.0);
}

TEST(Dtype, NamesAndSizesBelongTogether) {
  EXPECT_STREQ(dtype_name(dtype_of<std::uint8_t>()), "u8");
  EXPECT_STREQ(dtype_name(dtype_of<double>()), "f64");
  EXPECT_EQ(dtype_size(dtype_of<std::int16_t>()), 2);
  EXPECT_EQ(dtype_size(dtype_of<float>()), 4);
  EXPECT_EQ(dtype_size(dtype_of<Float16>()), 2);
  EXPECT_STREQ(dtype_name(dtype_of<std::uint64_t>()), "u64");
  EXPECT_EQ(dtype_size(0), 0);
  EXPECT_EQ(dtype_size(12), 0);
  EXPECT_EQ(dtype_size(-1), 0);
  EXPECT_STREQ(dtype_name(99), "unknown");
}

}  // namespace
}  // namespace weft
