// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>
#include <weft/data/owned.hpp>
#include <weft/data/shape.hpp>

namespace weft {
namespace {

TEST(Owned, HoldsWhatARecordBorrowedFromMemoryThatIsGone) {
  std::vector<double> memory(10, 1.5);  // two rows of three numbers, five apart
  Shape borrowing;
  borrowing.vertices_m = Array<double>::borrow(memory.data(), 2, {2, 3}, 5);
  borrowing.diag.set("draw", 0.25);
  const Shape own = owned_record(borrowing);
  std::fill(memory.begin(), memory.end(), 0.0);
  EXPECT_EQ(own.vertices_m.rows(), 2);
  EXPECT_TRUE(own.vertices_m.contiguous());
  EXPECT_TRUE((own.vertices_m.matrix<3>().array() == 1.5).all());
  EXPECT_FALSE(own.covariance_m2.present());
  EXPECT_EQ(own.diag.value("draw", 0.0), 0.25);
}

TEST(Owned, KeepsAllAxes) {
  const Array<double> arrays[] = {make_scalar(2.0), Array<double>({3}, 2.0),
                                  Array<double>({3, 0}, 2.0), Array<double>({3, 2, 5}, 2.0),
                                  Array<double>({3, 2, 5, 2}, 2.0)};
  int axes = 0;
  for (const Array<double>& array : arrays) {
    const Array<double> own = owned(array);
    EXPECT_EQ(own.ndim(), axes++);
    EXPECT_EQ(own.shape(), array.shape());
    EXPECT_NE(own.data(), array.data());
    for (std::int64_t i = 0; i < own.size(); ++i) EXPECT_EQ(own.data()[i], 2.0);
  }
}

}  // namespace
}  // namespace weft
