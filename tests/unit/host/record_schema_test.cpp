// SPDX-License-Identifier: Apache-2.0
#include "host/records/record_schema.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <weft/core/component_id.hpp>

#include "host/records/record.hpp"

namespace weft::host {
namespace {

using ::testing::HasSubstr;

const RecordSchema kDepth{"acme.depth/1",
                          {{"depth_m", "H,W", "m", "of each pixel", WEFT_F32, false, true},
                           {"sigma_m", "H,W", "m", "of the depth", WEFT_F64, true, false},
                           {"camera", "", "", "which one", WEFT_I32, false, false}}};

/// A record with depths of 2 x 3 pixels; each test damages a part of it.
class RecordSchemaTest : public ::testing::Test {
 protected:
  RecordSchemaTest() {
    fill<float>("depth_m", WEFT_F32, {2, 3}, 1.5F);
    fill<std::int32_t>("camera", WEFT_I32, {}, 4);
  }

  template <class T>
  T* fill(const char* name, std::int32_t dtype, std::vector<std::int64_t> shape, T value) {
    auto* data = static_cast<T*>(
        record_.allocate(name, dtype, static_cast<std::int32_t>(shape.size()), shape.data()));
    std::int64_t count = 1;
    for (const std::int64_t length : shape) count *= length;
    std::fill_n(data, count, value);
    return data;
  }

  std::string problem() const {
    const auto valid = validate(record_.view("acme.depth"), kDepth);
    return valid ? "" : valid.error().message;
  }

  Record record_{"acme.depth/1"};
};

TEST_F(RecordSchemaTest, WhatIsAsDeclaredIsValidWithAndWithoutItsOptionalArray) {
  EXPECT_EQ(problem(), "");
  fill<double>("sigma_m", WEFT_F64, {2, 3}, 0.1);
  EXPECT_EQ(problem(), "");
}

TEST_F(RecordSchemaTest, LettersOfAShapeAreOneLengthThroughoutTheRecord) {
  fill<double>("sigma_m", WEFT_F64, {2, 4}, 0.1);
  EXPECT_THAT(problem(), HasSubstr("acme.depth/1: array 'sigma_m' has length 4 on axis 1"));
}

TEST_F(RecordSchemaTest, ElementsOfAnotherTypeAreNamed) {
  fill<double>("depth_m", WEFT_F64, {2, 3}, 1.0);
  EXPECT_THAT(problem(), HasSubstr("'depth_m' has elements of type f64 where f32 is expected"));
}

TEST_F(RecordSchemaTest, ARequiredArrayIsMissed) {
  Record empty("acme.depth/1");
  const auto valid = validate(empty.view("acme.depth"), kDepth);
  ASSERT_FALSE(valid);
  EXPECT_THAT(valid.error().message, HasSubstr("'depth_m' is missing"));
}

TEST_F(RecordSchemaTest, NanIsLegalWhereItIsDeclaredAndNowhereElse) {
  fill<float>("depth_m", WEFT_F32, {2, 3}, std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(problem(), "");
  fill<double>("sigma_m", WEFT_F64, {2, 3}, 0.1)[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(problem(), HasSubstr("'sigma_m' holds NaN or infinity"));
}

TEST_F(RecordSchemaTest, UndeclaredArraysAreIgnored) {
  fill<double>("diag.rounds", WEFT_F64, {}, 7.0);
  EXPECT_EQ(problem(), "");
}

TEST(VendorRecords, AreCalledVendorNameAndVersion) {
  EXPECT_TRUE(is_vendor_record("acme.depth/1"));
  EXPECT_TRUE(is_vendor_record("a1.b_2/12"));
  for (const char* other :
       {"image/1", "acme.depth", "acme.depth/", "acme.depth/01", "acme.depth/v1", "acme./1",
        ".depth/1", "Acme.depth/1", "acme.depth/1.0", "image/1.0"}) {
    EXPECT_FALSE(is_vendor_record(other)) << other;
  }
}

TEST(VendorRecords, WordsOfElementTypesAreReadAsTheyAreWritten) {
  EXPECT_EQ(dtype_called("u8"), WEFT_U8);
  EXPECT_EQ(dtype_called("f64"), WEFT_F64);
  EXPECT_EQ(dtype_called("f16"), WEFT_F16);
  EXPECT_EQ(dtype_called("f128"), 0);
}

}  // namespace
}  // namespace weft::host
