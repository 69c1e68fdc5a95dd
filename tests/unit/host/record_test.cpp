// SPDX-License-Identifier: Apache-2.0
#include "host/records/record.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <iostream>
#include <limits>

#include "host/records/value_check.hpp"
#include "unit/data/random_record.hpp"

namespace weft::host {
namespace {

using ::testing::HasSubstr;
using testing_data::content_of;
using testing_data::random_record;

constexpr std::int64_t kThree[] = {3, 3, 3, 3, 3};

TEST(Record, AllocatesAlignedMemoryInCOrder) {
  Record record("inlier_mask/1");
  const std::int64_t shape[] = {4, 3, 2};
  auto* data = static_cast<double*>(record.allocate("x", WEFT_F64, 3, shape));
  ASSERT_NE(data, nullptr);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(data) % 64, 0U);
  const weft_record view = record.view("slot");
  ASSERT_EQ(view.count, 1U);
  const weft_array& array = view.arrays[0];
  EXPECT_STREQ(array.name, "x");
  EXPECT_EQ(array.data, data);
  EXPECT_EQ(array.ndim, 3);
  EXPECT_EQ(array.shape[0], 4);
  EXPECT_EQ(array.stride[0], 48);
  EXPECT_EQ(array.stride[1], 16);
  EXPECT_EQ(array.stride[2], 8);
  EXPECT_EQ(array.memory, WEFT_HOST);
}

TEST(Record, AllocatingANameAgainReplacesTheArray) {
  Record record("inlier_mask/1");
  record.allocate("a", WEFT_F64, 1, kThree);
  record.allocate("b", WEFT_U8, 0, nullptr);
  record.allocate("a", WEFT_I32, 2, kThree);
  const weft_record view = record.view("");
  ASSERT_EQ(view.count, 2U);
  EXPECT_EQ(view.arrays[0].dtype, WEFT_I32);
  EXPECT_EQ(view.arrays[0].ndim, 2);
  EXPECT_STREQ(view.arrays[1].name, "b");
}

TEST(Record, NamesStayValidWhenManyArraysAreAdded) {
  Record record("inlier_mask/1");
  for (int i = 0; i < 200; ++i) record.allocate("a" + std::to_string(i), WEFT_U8, 0, nullptr);
  const weft_record view = record.view("");
  for (int i = 0; i < 200; ++i) EXPECT_EQ(view.arrays[i].name, "a" + std::to_string(i));
}

TEST(Record, RefusesIllegalArrays) {
  Record record("inlier_mask/1");
  const std::int64_t negative[] = {2, -1}, large[] = {1 << 20, 1 << 20, 1 << 20};
  const std::int64_t hidden[] = {0, std::int64_t{1} << 62, 8};
  EXPECT_EQ(record.allocate("x", 0, 1, kThree), nullptr);
  EXPECT_EQ(record.allocate("x", 12, 1, kThree), nullptr);
  EXPECT_EQ(record.allocate("x", WEFT_U8, -1, kThree), nullptr);
  EXPECT_EQ(record.allocate("x", WEFT_U8, WEFT_MAX_DIMENSIONS + 1, kThree), nullptr);
  EXPECT_EQ(record.allocate("x", WEFT_U8, 2, negative), nullptr);
  EXPECT_EQ(record.allocate("x", WEFT_U8, 3, large), nullptr);
  EXPECT_EQ(record.allocate("x", WEFT_U8, 3, hidden), nullptr);
  EXPECT_EQ(record.allocate("x", WEFT_U8, 1, nullptr), nullptr);
  for (const char* name : {"", "../x", "a/b", "a b", "\xff", "a\nb"}) {
    EXPECT_EQ(record.allocate(name, WEFT_U8, 1, kThree), nullptr) << name;
  }
  EXPECT_EQ(record.allocate(std::string(101, 'x'), WEFT_U8, 1, kThree), nullptr);
  EXPECT_EQ(record.view("").count, 0U);
}

TEST(Record, EmptyArraysAndScalarsAreLegal) {
  Record record("inlier_mask/1");
  const std::int64_t none[] = {0, 3};
  EXPECT_NE(record.allocate("none", WEFT_F64, 2, none), nullptr);
  EXPECT_NE(record.allocate("scalar", WEFT_F64, 0, nullptr), nullptr);
}

TEST(Record, ArraysOfThirdPartiesAreLegalInAllRecordsWhateverTheyHold) {
  const std::int64_t six[] = {1, 2, 1, 2, 1, 2};
  for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
    Rng rng(9);
    const auto record = Record::copy_of(testing_data::random_record<RecordType>(rng));
    ASSERT_TRUE(validate(record->view(""))) << RecordType::kType;
    for (std::int32_t dtype = WEFT_U8; dtype <= WEFT_U64; ++dtype) {
      const std::string name = std::string("x.acme.") + dtype_name(dtype);
      void* data = record->allocate(name, dtype, 6, six);
      ASSERT_NE(data, nullptr);
      std::memset(data, 0xFF, to_index(8 * dtype_size(dtype)));  // NaN in floating point
    }
    const auto valid = validate(record->view(""));
    EXPECT_TRUE(valid) << valid.error().message;
  });
}

TEST(Record, RefusesAnArrayOfAThirdPartyWithoutAVendor) {
  for (const char* name : {"x.weight", "x.", "x..weight", "x.acme."}) {
    const auto record = Record::copy_of(Camera{});
    ASSERT_NE(record->allocate(name, WEFT_U8, 1, kThree), nullptr);
    const auto valid = validate(record->view(""));
    ASSERT_FALSE(valid) << name;
    EXPECT_EQ(valid.error().message,
              "camera/1: array '" + std::string(name) + "' must be called x.vendor.name");
  }
}

TEST(Record, SharesMemoryNotNames) {
  auto original = std::make_unique<Record>("inlier_mask/1");
  auto* data = static_cast<std::uint8_t*>(original->allocate("kept", WEFT_U8, 1, kThree));
  data[1] = 7;
  Record copy("inlier_mask/1");
  copy.share(*original, "kept");
  copy.share(*original, "absent");
  EXPECT_EQ(copy.view("").arrays[0].data, data);
  original.reset();  // the memory lives on
  ASSERT_EQ(copy.view("").count, 1U);
  EXPECT_STREQ(copy.view("").arrays[0].name, "kept");
  EXPECT_EQ(static_cast<std::uint8_t*>(copy.view("").arrays[0].data)[1], 7);
}

TEST(Record, EveryRecordTypeSurvivesBeingCopied) {
  std::cout << "seed 201\n";
  Rng rng(201);
  for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
    for (int round = 0; round < 10; ++round) {
      const RecordType typed = random_record<RecordType>(rng);
      const auto record = Record::copy_of(typed);
      ASSERT_NE(record, nullptr);
      EXPECT_EQ(content_of(record->view("")), content_of(typed)) << RecordType::kType;
      const auto valid = validate(record->view(""));
      EXPECT_TRUE(valid) << valid.error().message;
      const auto view = view_as<RecordType>(*record);
      ASSERT_TRUE(view);
      EXPECT_EQ(content_of(*view), content_of(typed)) << RecordType::kType;
    }
  });
}

TEST(Validate, FindsNumbersThatAreNotFiniteInEveryArray) {
  std::cout << "seed 202\n";
  Rng rng(202);
  const double bad[] = {std::nan(""), std::numeric_limits<double>::infinity(),
                        -std::numeric_limits<double>::infinity()};
  int checked = 0, allowed = 0;
  // Each iteration omits other optional arrays.
  for (int draw = 0; draw < 8; ++draw)
    for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
      const auto record = Record::copy_of(random_record<RecordType>(rng));
      RecordType typed;
      RecordType::fields(typed, [&](const auto&, const Field& field) {
        const weft_record view = record->view("");
        const weft_array* array = find_array(view, field.name);
        if (array == nullptr || array->dtype != WEFT_F64) return;
        for (int axis = 0; axis < array->ndim; ++axis) {
          if (array->shape[axis] == 0) return;
        }
        auto* last = static_cast<double*>(array->data);
        for (int axis = 0; axis < array->ndim; ++axis) {
          last += (array->shape[axis] - 1) * array->stride[axis] / 8;
        }
        const double before = *last;
        for (const double value : bad) {
          *last = value;
          const auto valid = validate(view);
          EXPECT_EQ(static_cast<bool>(valid), field.may_be_nan)
              << RecordType::kType << " " << field.name;
          if (!valid) {
            EXPECT_EQ(valid.error().message, std::string(RecordType::kType) + ": array '" +
                                                 field.name + "' holds NaN or infinity");
          }
        }
        *last = before;
        ++(field.may_be_nan ? allowed : checked);
      });
    });
  EXPECT_GT(checked, 20);
  EXPECT_GT(allowed, 0);
}

TEST(Validate, NamesAnUnknownType) {
  const auto valid = validate(Record("surprise/1").view(""));
  ASSERT_FALSE(valid);
  EXPECT_EQ(valid.error().message, "unknown record type surprise/1");
}

TEST(Validate, PassesUnknownArraysAndEvidenceThrough) {
  auto record = Record::copy_of(Time{0.5});
  *static_cast<double*>(record->allocate("vendor.extra", WEFT_F64, 0, nullptr)) = std::nan("");
  *static_cast<double*>(record->allocate("diag.ratio", WEFT_F64, 0, nullptr)) = std::nan("");
  EXPECT_TRUE(validate(record->view("")));
}

template <class RecordType>
std::string illegal_value(const RecordType& typed) {
  const auto legal = check_values(Record::copy_of(typed)->view(""));
  return legal ? "" : legal.error().message;
}

TEST(CheckValues, FindsWhatIsNoFlag) {
  Region region{Array<std::uint8_t>({9, 21}, 1)};
  EXPECT_EQ(illegal_value(region), "");
  for (const auto& [y, x] : {std::pair{0, 0}, {4, 7}, {8, 20}}) {
    region.mask(y, x) = 2;
    EXPECT_EQ(illegal_value(region), "region/1: array 'mask' holds 2 at [" + std::to_string(y) +
                                         "," + std::to_string(x) + "] where 0 or 1 is expected");
    region.mask(y, x) = 0;
  }
  EXPECT_EQ(illegal_value(Count{5, 7}), "count/1: array 'live' is 7 where 0 or 1 is expected");
}

TEST(CheckValues, FindsWhatIsNoShareAndLeavesRoundingAlone) {
  InlierMask mask{Array<std::uint8_t>({2}, 1), Array<double>({2}, 5.0), {}, make_scalar(1 + 1e-12)};
  EXPECT_EQ(illegal_value(mask), "");
  mask.confidence = make_scalar(-0.25);
  EXPECT_EQ(illegal_value(mask),
            "inlier_mask/1: array 'confidence' is -0.250000 where 0 to 1 is expected");
}

TEST(CheckValues, FindsStatesAndWeightsThatThereAreNotAndAcceptsLaterReasons) {
  Visibility seen{
      Array<std::uint8_t>({3}, 1), Array<double>({3}, 1.0), Array<std::uint8_t>({3}, 0), {}};
  seen.reason(2) = 5;
  EXPECT_EQ(illegal_value(seen), "") << "reasons are an open set";
  Shape shape;
  shape.vertices_m = Array<double>({1, 3}, 1.0);
  shape.source = Array<std::uint8_t>({1}, 1);
  EXPECT_EQ(illegal_value(shape), "");
  shape.state = 9;
  EXPECT_THAT(illegal_value(shape), HasSubstr("'state' is 9 where 1 to 4 is expected"));
  Sightlines lines;
  lines.vertex = lines.face = Array<std::int32_t>({1}, 0);
  lines.barycentrics = lines.ray = Array<double>({1, 3}, 0.0);
  lines.pixel_px = Array<double>({1, 2}, 0.0);
  lines.weight = Array<double>({1}, -1.0);
  EXPECT_THAT(illegal_value(lines), HasSubstr("'weight' holds -1.000000 at [0] where 0 or more"));
}

TEST(CheckLengths, ComparesAMaskWithItsMatches) {
  const auto mask = [](std::int64_t n) {
    return Record::copy_of(InlierMask{Array<std::uint8_t>({n}, 0), Array<double>({n}, 0.0), {}});
  };
  Record matches("correspondences/1");
  matches.allocate("kept", WEFT_U8, 1, kThree);
  const weft_record inputs[] = {matches.view("correspondences")};
  EXPECT_TRUE(check_lengths(mask(3)->view("inlier_mask"), inputs));
  const auto wrong = check_lengths(mask(4)->view("inlier_mask"), inputs);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().message,
            "inlier_mask/1 has 4 entries for 3 of the input 'correspondences'");
  EXPECT_TRUE(check_lengths(mask(4)->view("inlier_mask"), {}));
}

}  // namespace
}  // namespace weft::host
