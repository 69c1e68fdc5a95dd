// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>
#include <weft/data/codec.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/owned.hpp>

namespace weft {
namespace {

TEST(Owned, HoldsWhatARecordBorrowedFromMemoryThatIsGone) {
  std::vector<double> memory(10, 1.5);  // two rows of three numbers, with a stride of five
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

TEST(Owned, HoldsArraysOfOthersButNoRevision) {
  std::vector<std::uint16_t> memory{65535, 7};
  weft_array extra{};
  extra.name = "x.acme.weight";
  extra.dtype = WEFT_U16;
  extra.ndim = 1;
  extra.shape[0] = 2;
  extra.stride[0] = 2;
  extra.data = memory.data();
  const Points points{Array<double>({2, 2}, 0.0), 1};
  const RecordView<Points> view("", points);
  std::vector<weft_array> arrays(view.raw().arrays, view.raw().arrays + view.raw().count);
  arrays.push_back(extra);
  weft_record record = view.raw();
  record.arrays = arrays.data();
  record.count = arrays.size();
  record.revision = 4;
  const Points own = owned_record(*read_record<Points>(record));
  memory.assign(2, 0);
  arrays.clear();
  const auto* weight = own.others.find<std::uint16_t>("x.acme.weight");
  ASSERT_NE(weight, nullptr);
  EXPECT_EQ((*weight)(0), 65535);
  const RecordView<Points> again("", own);
  EXPECT_EQ(again.raw().revision, 0U);
  EXPECT_EQ(again.raw().count, 3U);
}

TEST(Owned, KeepsAllAxes) {
  const Array<double> arrays[] = {make_scalar(2.0),
                                  Array<double>({3}, 2.0),
                                  Array<double>({3, 0}, 2.0),
                                  Array<double>({3, 2, 5}, 2.0),
                                  Array<double>({3, 2, 5, 2}, 2.0),
                                  Array<double>({3, 2, 5, 2, 2}, 2.0),
                                  Array<double>({3, 2, 1, 2, 2, 3}, 2.0)};
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
