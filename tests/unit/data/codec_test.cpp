// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <limits>
#include <set>
#include <stdexcept>
#include <weft/core/index.hpp>
#include <weft/data/codec.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/owned.hpp>

#include "unit/data/random_record.hpp"

namespace weft {
namespace {

using ::testing::HasSubstr;
using testing_data::Content;
using testing_data::content_of;
using testing_data::PaddedRecord;
using testing_data::random_record;

constexpr int kRounds = 25;

/// Memory for what write_record writes; refuses the array `refused`.
struct Store {
  std::string refused;
  std::vector<weft_array> arrays;
  std::vector<std::unique_ptr<std::string>> names;
  std::vector<std::unique_ptr<std::vector<std::uint64_t>>> memory;

  void* operator()(const char* name, std::int32_t dtype, int ndim, const std::int64_t* shape) {
    if (name == refused) return nullptr;
    weft_array array{};
    array.name = names.emplace_back(std::make_unique<std::string>(name))->c_str();
    array.dtype = dtype;
    array.ndim = ndim;
    std::int64_t stride = dtype_size(dtype);
    for (int axis = ndim - 1; axis >= 0; --axis) {
      array.shape[axis] = shape[axis];
      array.stride[axis] = stride;
      stride *= shape[axis];
    }
    const auto words = to_index(stride) / 8 + 1;
    array.data = memory.emplace_back(std::make_unique<std::vector<std::uint64_t>>(words))->data();
    arrays.push_back(array);
    return array.data;
  }
};

weft_record record_of(const char* type, const std::vector<weft_array>& arrays) {
  weft_record record{};
  record.slot = "";
  record.type = type;
  record.count = arrays.size();
  record.arrays = arrays.data();
  return record;
}

TEST(Codec, EveryRecordTypeSurvivesBeingViewedAndReadBack) {
  std::cout << "seed 101\n";
  Rng rng(101);
  for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
    for (int round = 0; round < kRounds; ++round) {
      const RecordType typed = random_record<RecordType>(rng);
      const RecordView<RecordType> view("slot", typed);
      EXPECT_STREQ(view.raw().slot, "slot");
      const auto read = read_record<RecordType>(view.raw());
      ASSERT_TRUE(read) << RecordType::kType << ": " << read.error().message;
      EXPECT_EQ(content_of(*read), content_of(typed)) << RecordType::kType;
    }
  });
}

TEST(Codec, EveryRecordTypeSurvivesBeingWrittenAndReadBack) {
  std::cout << "seed 102\n";
  Rng rng(102);
  for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
    for (int round = 0; round < kRounds; ++round) {
      const RecordType typed = random_record<RecordType>(rng);
      Store store;
      ASSERT_TRUE(write_record(typed, store));
      const weft_record record = record_of(RecordType::kType, store.arrays);
      const auto read = read_record<RecordType>(record);
      ASSERT_TRUE(read) << RecordType::kType << ": " << read.error().message;
      EXPECT_EQ(content_of(*read), content_of(typed)) << RecordType::kType;
    }
  });
}

/// An array of three numbers that a later version made: its reserved words have a meaning.
weft_array later_array(const char* name, std::int32_t dtype, void* data) {
  static int owner = 0;
  weft_array array{};
  array.name = name;
  array.dtype = dtype;
  array.ndim = 1;
  array.shape[0] = 3;
  array.stride[0] = 8;
  array.data = data;
  array.owner = &owner;
  array.reserved_word = 5;
  array.reserved[0] = 6;
  array.reserved[1] = 7;
  return array;
}

void expect_passed_on(const weft_record& passed, const weft_array& given) {
  const weft_array* array = find_array(passed, given.name);
  ASSERT_NE(array, nullptr) << given.name;
  EXPECT_EQ(array->dtype, given.dtype);
  EXPECT_EQ(array->data, given.data);
  EXPECT_EQ(array->owner, given.owner);
  EXPECT_EQ(array->reserved_word, 5);
  EXPECT_EQ(array->reserved[0], 6U);
  EXPECT_EQ(array->reserved[1], 7U);
}

TEST(Codec, ReservedWordsOwnersAndUnknownElementsArePassedOnWithARecord) {
  std::array<double, 3> numbers{0.1, 0.2, 0.3};
  constexpr std::int32_t kOfALaterVersion = 77;
  const std::vector<weft_array> arrays{later_array("weight", WEFT_F64, numbers.data()),
                                       later_array("x.acme.words", WEFT_U64, numbers.data()),
                                       later_array("novel", kOfALaterVersion, numbers.data())};
  weft_record record = record_of(Weights::kType, arrays);
  record.frame = 4;
  record.reserved[0] = 8;
  record.reserved[2] = 9;
  const auto read = read_record<Weights>(record);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_NE(read->others.find<std::uint64_t>("x.acme.words"), nullptr);
  const RecordView<Weights> passed("weights", *read);
  EXPECT_EQ(passed.raw().count, 3U);
  EXPECT_EQ(passed.raw().frame, 4);
  EXPECT_EQ(passed.raw().reserved[0], 8U);
  EXPECT_EQ(passed.raw().reserved[2], 9U);
  for (const weft_array& given : arrays) expect_passed_on(passed.raw(), given);
  const Weights owned = owned_record(*read);
  const RecordView<Weights> copy("weights", owned);
  EXPECT_EQ(copy.raw().count, 2U) << "an array of unknown size cannot be copied";
}

TEST(Codec, NumbersOfSixteenBitsConvertToTheirValues) {
  const std::pair<std::uint16_t, double> pairs[] = {
      {0x0000, 0.0},
      {0x3C00, 1.0},
      {0xC000, -2.0},
      {0x3555, 0.333251953125},
      {0x0001, 5.9604644775390625e-8},
      {0x7BFF, 65504.0},
      {0xFC00, -std::numeric_limits<double>::infinity()}};
  for (const auto& [bits, value] : pairs) {
    EXPECT_EQ(static_cast<double>(Float16{bits}), value) << bits;
  }
  EXPECT_TRUE(std::isnan(static_cast<double>(Float16{0x7E00})));
}

TEST(Codec, RowsMayBePaddedOrReversedOnInput) {
  std::cout << "seed 103\n";
  Rng rng(103);
  for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
    for (int round = 0; round < kRounds; ++round) {
      const RecordType typed = random_record<RecordType>(rng);
      const RecordView<RecordType> view("", typed);
      const PaddedRecord padded(view.raw(), round % 2 == 1);
      const auto read = read_record<RecordType>(padded.raw());
      ASSERT_TRUE(read) << RecordType::kType << ": " << read.error().message;
      EXPECT_EQ(content_of(*read), content_of(typed)) << RecordType::kType;
      Store store;  // and are made dense when written
      ASSERT_TRUE(write_record(*read, store));
      const weft_record record = record_of(RecordType::kType, store.arrays);
      EXPECT_EQ(content_of(record), content_of(typed)) << RecordType::kType;
    }
  });
}

TEST(Codec, PaddedRowsAreSeenThroughEigenAndThroughIndices) {
  const double memory[] = {1, 2, -1, 3, 4, -1, 5, 6, -1};
  const auto array = Array<double>::borrow(memory, 2, {3, 2}, 3);
  EXPECT_EQ(array.matrix<2>(), (Eigen::Matrix<double, 3, 2>() << 1, 2, 3, 4, 5, 6).finished());
  EXPECT_EQ(array(2, 1), 6.0);
  EXPECT_FALSE(array.contiguous());
}

TEST(Codec, EveryRequiredArrayIsMissed) {
  std::cout << "seed 104\n";
  Rng rng(104);
  int required = 0;
  for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
    const RecordType typed = random_record<RecordType>(rng);
    const RecordView<RecordType> view("", typed);
    RecordType::fields(typed, [&](const auto&, const Field& field) {
      if (field.optional) return;
      ++required;
      std::vector<weft_array> others;
      for (std::uint64_t i = 0; i < view.raw().count; ++i) {
        const weft_array& array = view.raw().arrays[i];
        if (std::string(array.name) != field.name) others.push_back(array);
      }
      weft_record record = view.raw();
      record.count = others.size();
      record.arrays = others.data();
      const auto read = read_record<RecordType>(record);
      ASSERT_FALSE(read) << RecordType::kType << " without " << field.name;
      EXPECT_EQ(read.error().code, Errc::invalid_data);
      EXPECT_EQ(read.error().message,
                std::string(RecordType::kType) + ": array '" + field.name + "' is missing");
    });
  });
  EXPECT_GT(required, 50);
}

TEST(Codec, EveryArrayOfAnotherElementTypeIsRefused) {
  std::cout << "seed 105\n";
  Rng rng(105);
  for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
    const RecordType typed = random_record<RecordType>(rng);
    const RecordView<RecordType> view("", typed);
    for (std::uint64_t i = 0; i < view.raw().count; ++i) {
      std::vector<weft_array> arrays(view.raw().arrays, view.raw().arrays + view.raw().count);
      const std::string name = arrays[i].name;
      if (name.starts_with("diag.") || name.starts_with("model.")) continue;
      arrays[i].dtype = arrays[i].dtype == WEFT_I16 ? WEFT_U16 : WEFT_I16;
      weft_record record = view.raw();
      record.arrays = arrays.data();
      const auto read = read_record<RecordType>(record);
      ASSERT_FALSE(read) << RecordType::kType << " " << name;
      EXPECT_THAT(read.error().message, HasSubstr("'" + name + "' has elements of type i16 where"));
    }
  });
}

TEST(Codec, ArraysOfDifferentLengthsUnderOneLetterAreRefused) {
  KnownPoints points;
  points.vertex = Array<std::int32_t>({4}, 0);
  points.points_m = Array<double>({4, 3}, 0.0);
  points.radius_m = Array<double>({3}, 0.0);
  const auto read = read_record<KnownPoints>(RecordView<KnownPoints>("", points).raw());
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().message,
            "known_points/1: array 'radius_m' has length 3 on axis 0 where P = 4 is expected");
}

TEST(Codec, ARecordOfAnotherTypeIsRefused) {
  const Time time{0.5};
  const auto read = read_record<Camera>(RecordView<Time>("", time).raw());
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().message, "expected a record camera/1, got time/1");
}

TEST(Codec, EvidenceThatCannotBeReadIsLeftOut) {
  InlierMask mask{Array<std::uint8_t>({1}, 0), Array<double>({1}, 0.0), {}};
  mask.diag.set("good", 1.0);
  mask.diag.set("torn", Array<double>({2, 2}, 0.0));
  const RecordView<InlierMask> view("", mask);
  std::vector<weft_array> arrays(view.raw().arrays, view.raw().arrays + view.raw().count);
  arrays.back().stride[1] = 24;
  weft_record record = view.raw();
  record.arrays = arrays.data();
  const auto read = read_record<InlierMask>(record);
  ASSERT_TRUE(read);
  ASSERT_EQ(read->diag.entries().size(), 1U);
  EXPECT_EQ(read->diag.value("good", 0.0), 1.0);
  EXPECT_EQ(read->diag.value("absent", -3.0), -3.0);
}

TEST(Codec, ARefusedArrayIsNamed) {
  Store store;
  store.refused = "score";
  const InlierMask mask{Array<std::uint8_t>({1}, 0), Array<double>({1}, 0.0), {}};
  const auto written = write_record(mask, store);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, Errc::plugin_failure);
  EXPECT_THAT(written.error().message, HasSubstr("'score' of inlier_mask/1"));
}

TEST(Codec, RevisionAndProducerTravelWithTheRecord) {
  Template templ;
  templ.revision = 77;
  Warp warp;
  warp.producer_handle = 5;
  EXPECT_EQ(RecordView<Template>("", templ).raw().revision, 77U);
  EXPECT_EQ(RecordView<Warp>("", warp).raw().producer, 5U);
  warp.domain_px = Array<double>({4}, 0.0);
  const auto read = read_record<Warp>(RecordView<Warp>("", warp).raw());
  ASSERT_TRUE(read);
  EXPECT_EQ(read->producer_handle, 5U);
}

/// A record of three matches with more arrays than the catalogue names.
struct Extended {
  Extended() {
    matches.template_px = matches.image_px = Array<double>({3, 2}, 1.0);
    matches.face = Array<std::int32_t>({3}, 0);
    matches.barycentrics = Array<double>({3, 3}, 0.0);
    matches.kept = Array<std::uint8_t>({3}, 1);
    matches.score = Array<double>({3}, 1.0);
    matches.diag.set("ids", ids);
    for (std::int64_t i = 0; i < 3; ++i) {
      weight(i) = static_cast<std::uint16_t>(65533 + i);
      ids(i) = std::numeric_limits<std::int32_t>::min() + static_cast<std::int32_t>(i);
    }
    const RecordView<Correspondences> view("", matches);
    arrays.assign(view.raw().arrays, view.raw().arrays + view.raw().count);
    weft_array newer = arrays.front();
    newer.name = "normal_px";  // as a later catalogue may call one
    arrays.push_back(newer);
    newer = {};
    newer.name = "x.acme.weight";
    newer.dtype = WEFT_U16;
    newer.ndim = 1;
    newer.shape[0] = 3;
    newer.stride[0] = 2;
    newer.data = weight.data();
    arrays.push_back(newer);
    record = view.raw();
    record.arrays = arrays.data();
    record.count = arrays.size();
    record.revision = 5;
    record.frame = 8;
    record.view = 1;
    record.object = 2;
  }

  Correspondences read() const { return *read_record<Correspondences>(record); }

  Array<std::uint16_t> weight{{3}};
  Array<std::int32_t> ids{{3}};
  Correspondences matches;
  std::vector<weft_array> arrays;
  weft_record record{};
};

testing_data::Content sorted(testing_data::Content content) {
  std::sort(content.begin(), content.end());
  return content;
}

TEST(Codec, EvidenceOfAnyTypeArrivesBitForBit) {
  const Extended extended;
  const Correspondences read = extended.read();
  const auto* ids = read.diag.find<std::int32_t>("ids");
  ASSERT_NE(ids, nullptr);
  EXPECT_EQ(ids->data(), extended.ids.data());
  EXPECT_EQ((*ids)(2), std::numeric_limits<std::int32_t>::min() + 2);
  EXPECT_EQ(read.diag.find<double>("ids"), nullptr) << "it has another type";
}

TEST(Codec, ARecordThatIsPassedOnAsItWasReadLosesNothing) {
  const Extended extended;
  const Correspondences read = extended.read();
  const auto* weight = read.others.find<std::uint16_t>("x.acme.weight");
  ASSERT_NE(weight, nullptr);
  EXPECT_EQ(weight->data(), extended.weight.data()) << "borrowed";
  const Correspondences copy = read;
  for (const Correspondences* each : {&read, &copy}) {
    const RecordView<Correspondences> view("", *each);
    EXPECT_EQ(sorted(content_of(view.raw())), sorted(content_of(extended.record)));
    EXPECT_EQ(view.raw().revision, 5U);
    EXPECT_EQ(view.raw().frame, 8);
    EXPECT_EQ(view.raw().view, 1);
    EXPECT_EQ(view.raw().object, 2);
  }
  Store store;
  ASSERT_TRUE(write_record(read, store));
  EXPECT_EQ(sorted(content_of(record_of(Correspondences::kType, store.arrays))),
            sorted(content_of(extended.record)));
}

TEST(Codec, ARecordThatWasChangedHasNoRevisionAndKeepsArraysOfOthersWhileItsLengthsStay) {
  const Extended extended;
  const auto others_after = [&](auto&& change) {
    Correspondences read = extended.read();
    change(read);
    const RecordView<Correspondences> view("", read);
    EXPECT_EQ(view.raw().revision, 0U);
    EXPECT_EQ(view.raw().frame, 8);
    int left = 0;
    for (const auto& array : content_of(view.raw())) {
      const std::string& name = std::get<0>(array);
      left += name == "x.acme.weight" || name == "normal_px" ? 1 : 0;
    }
    return left;
  };
  EXPECT_EQ(others_after([](auto& read) { read.kept = Array<std::uint8_t>({3}, 1); }), 2);
  EXPECT_EQ(others_after([](auto& read) { read.confidence = make_scalar(0.5); }), 2);
  EXPECT_EQ(others_after([](auto& read) { read.distance = Array<double>({3}, 1.0); }), 2);
  EXPECT_EQ(others_after([](auto& read) { read.diag.set("more", 1.0); }), 2);
  EXPECT_EQ(others_after(
                [](auto& read) { read.others.set("x.acme.weight", Array<std::uint16_t>({3}, 1)); }),
            2)
      << "what a component sets itself takes the place of what it was given";
  EXPECT_EQ(others_after([](auto& read) {
              read.template_px = read.image_px = Array<double>({2, 2}, 1.0);
              read.face = Array<std::int32_t>({2}, 0);
              read.barycentrics = Array<double>({2, 3}, 0.0);
              read.kept = Array<std::uint8_t>({2}, 1);
              read.score = Array<double>({2}, 1.0);
            }),
            0)
      << "nobody knows which of them the two were";
  EXPECT_EQ(others_after([](auto& read) {
              read.kept = Array<std::uint8_t>({3}, 1);
              read.others.drop();
            }),
            0);
  Template templ;
  templ.revision = 9;
  templ.vertices_m = Array<double>({3, 3}, 0.0);
  templ.flat_px = Array<double>({3, 2}, 0.0);
  templ.faces = Array<std::int32_t>({1, 3}, 0);
  templ.texture = templ.mask = Array<std::uint8_t>({2, 2}, 0);
  const RecordView<Template> view("", templ);
  Template read = *read_record<Template>(view.raw());
  EXPECT_EQ(RecordView<Template>("", read).raw().revision, 9U);
  read.vertices_m = Array<double>({3, 3}, 0.0);
  EXPECT_EQ(RecordView<Template>("", read).raw().revision, 0U);
}

TEST(Codec, AnArrayOfAThirdPartyIsCalledByItsVendor) {
  Camera camera;
  EXPECT_THROW(camera.others.set("weight", Array<double>({1}, 0.0)), std::invalid_argument);
  EXPECT_THROW(camera.others.set("x.weight", Array<double>({1}, 0.0)), std::invalid_argument);
  camera.others.set("x.acme.weight", Array<double>({1}, 0.0));
  camera.others.set("x.acme.weight", Array<float>({1}, 0.5F));
  EXPECT_EQ(camera.others.find<double>("x.acme.weight"), nullptr) << "it was replaced";
  EXPECT_EQ((*camera.others.find<float>("x.acme.weight"))(0), 0.5F);
}

TEST(Catalogue, TypesAreVersionedAndNamesAreUnique) {
  std::set<std::string> types;
  for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
    const std::string type = RecordType::kType;
    EXPECT_TRUE(type.ends_with("/1")) << type;
    EXPECT_TRUE(types.insert(type).second) << type;
    std::set<std::string> names;
    RecordType typed;
    RecordType::fields(typed, [&](const auto&, const Field& field) {
      EXPECT_TRUE(names.insert(field.name).second) << type << " " << field.name;
      EXPECT_STRNE(field.meaning, "") << type << " " << field.name;
    });
  });
  EXPECT_EQ(types.size(), 22U);
}

}  // namespace
}  // namespace weft
