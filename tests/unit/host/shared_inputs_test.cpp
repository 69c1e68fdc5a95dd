// SPDX-License-Identifier: Apache-2.0
#include "host/workers/shared_inputs.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "host/records/record.hpp"

namespace weft::host {
namespace {

class SharedInputsTest : public ::testing::Test {
 protected:
  /// [3,2] doubles from `data` on, `step` bytes from row to row.
  static weft_array rows(const double* data, std::int64_t step) {
    weft_array array{};
    array.name = "xy_px";
    array.dtype = WEFT_F64;
    array.ndim = 2;
    array.shape[0] = 3;
    array.shape[1] = 2;
    array.stride[0] = step;
    array.stride[1] = sizeof(double);
    array.data = const_cast<double*>(data);
    return array;
  }

  PlacedArray place(const weft_array& array) {
    const weft_record record{"points", "points/1", 5, 7, 1, &array, 3, 0, 0, {}};
    const auto placed = inputs_.place(record, keep_);
    if (!placed) throw std::runtime_error(placed.error().message);
    return placed->arrays.at(0);
  }

  std::vector<double> read(const PlacedArray& placed) const {
    const auto* data = static_cast<const double*>(arena_->memory().at(placed.offset, 48));
    return {data, data + 6};
  }

  const std::shared_ptr<SharedArena> arena_ = *SharedArena::create(1U << 20U);
  SharedInputs inputs_{arena_};
  std::vector<std::shared_ptr<void>> keep_;
};

TEST_F(SharedInputsTest, WhatWasBornThereIsNotCopied) {
  Record record("points/1", arena_);
  const std::int64_t shape[] = {3, 2};
  const void* data = record.allocate("xy_px", WEFT_F64, 2, shape);
  EXPECT_EQ(place(record.view("points").arrays[0]).offset, arena_->memory().offset_of(data));
  EXPECT_TRUE(keep_.empty());
}

TEST_F(SharedInputsTest, RowsWithALargeOrNegativeStrideAreCopiedTogether) {
  const double data[] = {1, 2, -1, 3, 4, -1, 5, 6, -1};
  const PlacedArray padded = place(rows(data, 24));
  EXPECT_EQ(read(padded), (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(padded.stride[0], 16);
  EXPECT_EQ(read(place(rows(data + 6, -24))), (std::vector<double>{5, 6, 3, 4, 1, 2}));
  EXPECT_EQ(keep_.size(), 2U);
}

TEST_F(SharedInputsTest, WhatAWorkerMadeIsCopiedOnceWhileItLives) {
  const double data[] = {1, 2, 3, 4, 5, 6};
  const weft_array array = rows(data, 16);
  EXPECT_NE(place(array).offset, place(array).offset) << "nobody vouches for its content";
  keep_.clear();
  inputs_.watch(data);
  const std::uint64_t offset = place(array).offset;
  keep_.clear();
  EXPECT_EQ(place(array).offset, offset);
  keep_.clear();
  const std::shared_ptr<void> other = arena_->allocate(48);
  EXPECT_NE(arena_->memory().offset_of(other.get()), offset) << "the copy is still there";
  inputs_.forget(data);
  const std::shared_ptr<void> next = arena_->allocate(48);
  EXPECT_EQ(arena_->memory().offset_of(next.get()), offset) << "the copy is gone";
}

TEST_F(SharedInputsTest, WhatDoesNotFitIsAnError) {
  const std::vector<double> data(200'000);
  weft_array array = rows(data.data(), 16);
  array.shape[0] = 100'000;
  const weft_record record{"points", "points/1", 0, 0, 1, &array, 3, 0, 0, {}};
  const auto placed = inputs_.place(record, keep_);
  ASSERT_FALSE(placed);
  EXPECT_NE(placed.error().message.find("'xy_px' of 1600000 bytes"), std::string::npos);
}

}  // namespace
}  // namespace weft::host
